//! The flags of `render` that set axes: one for each name of an axis, made from the list of axes.

use clap::builder::ValueParser;
use clap::error::ErrorKind;
use clap::{Arg, ArgMatches, Args, Command, Error, FromArgMatches};
use splitsum::runner::axis::named::{ambiguous, hint};
use splitsum::runner::axis::{AXES, Named, Part, Point};
use splitsum::runner::value::{Kind, Value};

/// The axes that flags set.
#[derive(Clone, Debug, Default)]
pub struct AxisFlags(Vec<Given>);

/// A flag that was given.
#[derive(Clone, Debug)]
pub struct Given {
    /// The flag without its dashes.
    pub flag: String,
    /// Index into [`AXES`].
    pub axis: usize,
    value: Value,
}

impl AxisFlags {
    /// The flags as a point; an axis without a flag has its default.
    pub fn point(&self) -> Point {
        let mut point = Point::default();
        self.0.iter().for_each(|given| point[given.axis] = given.value.clone());
        point
    }

    /// The value of an axis, where a flag sets it.
    pub fn get(&self, axis: usize) -> Option<&Value> {
        self.0.iter().find(|given| given.axis == axis).map(|given| &given.value)
    }

    /// Every flag that was given.
    pub fn iter(&self) -> impl Iterator<Item = &Given> {
        self.0.iter()
    }
}

/// The flag of a name: `--lod-bias` sets `lod_bias`.
fn flag(named: Named) -> String {
    let name = if named.is_second() { named.name() } else { named.entry().flag.unwrap_or(named.name()) };
    name.replace('_', "-")
}

/// The heading that the help puts an axis under.
fn heading(part: Part) -> &'static str {
    match part {
        Part::Case => "Scene and light",
        Part::Method | Part::Count | Part::Parameter | Part::Luck => "Method",
        Part::Table => "Tables",
        Part::Display => "Tone curve, of a .png",
    }
}

/// One line of help: the phrase, the values, the default.
fn help(named: Named) -> String {
    let about = named.about();
    let first = about.chars().next().map(|c| c.to_uppercase().to_string()).unwrap_or_default();
    let default = if named.is_second() { Value::Unset } else { (named.entry().default)() };
    let values = if matches!(named.kind(), Kind::Input) { String::new() } else { named.kind().describe() };
    let default = if default == Value::Unset { String::new() } else { format!("default {default}") };
    let facts: Vec<String> = [values, default].into_iter().filter(|text| !text.is_empty()).collect();
    let rest = &about[about.chars().next().map_or(0, char::len_utf8)..];
    if facts.is_empty() { format!("{first}{rest}") } else { format!("{first}{rest} [{}]", facts.join("; ")) }
}

impl Args for AxisFlags {
    fn augment_args(command: Command) -> Command {
        let flags = Named::all().map(|named| {
            let arg = Arg::new(named.name())
                .long(flag(named))
                .value_name(named.kind().value_name())
                .help(help(named))
                .help_heading(heading(named.entry().part))
                .allow_hyphen_values(named.kind().has_negative())
                .value_parser(ValueParser::new(move |text: &str| named.parse_text(text)));
            if named.is_second() { arg.conflicts_with(AXES[named.axis].name) } else { arg }
        });
        let hints = ambiguous().map(|name| {
            let refuse = move |_: &str| Err::<Value, _>(hint(name, &[]).trim_start_matches("; ").to_owned());
            Arg::new(name).long(name).hide(true).value_parser(ValueParser::new(refuse))
        });
        command.args(flags.collect::<Vec<_>>()).args(hints.collect::<Vec<_>>())
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for AxisFlags {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        let mut flags = Self::default();
        flags.update_from_arg_matches(matches)?;
        Ok(flags)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        for named in Named::all() {
            let value = matches.try_get_one::<Value>(named.name());
            if let Some(value) = value.map_err(|error| Error::raw(ErrorKind::InvalidValue, error))? {
                self.0.push(Given { flag: flag(named), axis: named.axis, value: value.clone() });
            }
        }
        Ok(())
    }
}
