//! Flags of `render` and `view`: the view, and one for each axis, made from the list of axes.

use super::Failure;
use super::completed::Completed;
use super::shared::{DeviceFlag, InputFlags};
use clap::builder::ValueParser;
use clap::{Arg, ArgMatches, Args, Command, Error, FromArgMatches};
use splitsum::base::names::{Listed, capitalised};
use splitsum::experiment::axis::named::ambiguous;
use splitsum::experiment::axis::{AXES, AxisId, Named, Point, Reference, View};
use splitsum::experiment::config::SEED;
use splitsum::experiment::lights::parse_light;
use splitsum::experiment::value::{COORDINATE, Kind, Value};
use splitsum::instrument::scene::{CameraKind, Light, Orbit, Scene};

/// Flags other than the axes.
#[derive(Args, Clone, Debug)]
pub struct ViewFlags {
    /// Choose the camera: ortho or perspective.
    #[arg(
        long,
        value_name = "NAME",
        default_value = CameraKind::names()[0],
        value_parser = |name: &str| CameraKind::parse(name).copied(),
    )]
    camera: CameraKind,
    /// Turn the camera: yaw and pitch in degrees, and a distance factor in [0.1, 4].
    #[arg(
        long,
        value_name = "YAW,PITCH,DISTANCE",
        allow_hyphen_values = true,
        value_parser = parse_orbit,
    )]
    pub orbit: Option<Orbit>,
    /// Show the environment behind the scene.
    #[arg(long)]
    pub background: bool,
    /// Add a direct light, such as directional:direction=0,-1,-1:intensity=3.
    #[arg(
        long = "light",
        value_name = "KIND:FIELD=VALUE:...",
        value_parser = parse_light,
        action = clap::ArgAction::Append,
    )]
    pub lights: Vec<Light>,
    /// Seed the reference's samples.
    #[arg(
        long,
        value_name = "N",
        default_value = "1",
        value_parser = |text: &str| SEED.parse_text(text),
    )]
    seed: Value,
    #[command(flatten)]
    pub inputs: InputFlags,
    #[command(flatten)]
    pub device: DeviceFlag,
}

impl ViewFlags {
    /// Builds the view, with a reference's default sample count.
    pub fn view(&self) -> View {
        View {
            camera: self.camera,
            orbit: self.orbit.unwrap_or_default(),
            background: self.background,
            antialias: false,
            lights: self.lights.clone(),
            seed: self.seed.count(),
            reference_error: None,
            reference_samples: Reference::default().samples,
        }
    }

    /// Refuses flags that have no effect on the scene.
    pub fn check(&self, scene: &Scene) -> Result<(), Failure> {
        if !scene.is_design {
            return Ok(());
        }
        let flags = [
            ("background", self.background),
            ("orbit", self.orbit.is_some()),
        ];
        let mut faults: Vec<String> = flags
            .iter()
            .filter(|(_, is_set)| *is_set)
            .map(|(flag, _)| format!("--{flag}: has no effect on the scene design; leave it out"))
            .collect();
        if self.lights.iter().any(Light::has_position) {
            let fault = "--light: surfaces of the scene design have no position; expected a \
                         directional light";
            faults.push(fault.to_owned());
        }
        if faults.is_empty() {
            Ok(())
        } else {
            Err(Failure::input(faults.join("\n")))
        }
    }
}

/// Parses `x,y,z`.
pub fn coordinates(text: &str) -> Result<[f32; 3], String> {
    // A colour may be one number, a place may not.
    let has_three = text.split(',').count() == 3;
    match Kind::Color(COORDINATE).parse_text(text) {
        Ok(Value::Color(numbers)) if has_three => Ok(numbers),
        _ => Err(format!("{text:?} is not x,y,z")),
    }
}

fn parse_orbit(text: &str) -> Result<Orbit, String> {
    coordinates(text)
        .map_err(|_| format!("{text:?} is not yaw,pitch,distance, such as 30,10,1"))
        .and_then(Orbit::new)
}

/// The flags of axes that the user wrote.
#[derive(Clone, Debug, Default)]
pub struct AxisFlags(Vec<AxisFlag>);

#[derive(Clone, Debug)]
pub struct AxisFlag {
    /// Without its dashes.
    pub flag: String,
    /// Index into [`AXES`].
    pub axis: AxisId,
    pub value: Value,
}

impl AxisFlags {
    /// Returns the point; axes without a flag have their defaults.
    pub fn point(&self) -> Point {
        let mut point = Point::default();
        for flag in &self.0 {
            point[flag.axis] = flag.value.clone();
        }
        point
    }

    pub fn get(&self, axis: AxisId) -> Option<&Value> {
        self.0
            .iter()
            .find(|flag| flag.axis == axis)
            .map(|flag| &flag.value)
    }

    pub fn iter(&self) -> impl Iterator<Item = &AxisFlag> {
        self.0.iter()
    }
}

/// Writes one line of help: phrase, values, default.
fn help(named: Named) -> String {
    let about = capitalised(named.about());
    let mut facts = Vec::new();
    if !matches!(named.kind(), Kind::Input) {
        facts.push(named.kind().describe());
    }
    let default = (named.entry().default)();
    if default != Value::Unset && !named.is_second() {
        facts.push(format!("default: {default}"));
    }
    if facts.is_empty() {
        about
    } else {
        format!("{about} [{}]", facts.join("; "))
    }
}

fn flag(named: Named) -> Arg {
    let arg = Arg::new(named.name())
        .long(named.flag())
        .value_name(named.kind().value_name())
        .help(help(named))
        .help_heading(named.entry().part.heading())
        .allow_hyphen_values(
            named.kind().has_negative() || matches!(named.kind(), Kind::Pair { .. }),
        )
        // The help has the names of short lists already.
        .hide_possible_values(true)
        .value_parser(Completed::new(
            move |text: &str| named.parse_text(text),
            named.kind().only_names(),
        ));
    if named.is_second() {
        arg.conflicts_with(AXES[named.axis].name)
    } else {
        arg
    }
}

impl Args for AxisFlags {
    fn augment_args(command: Command) -> Command {
        let hints = ambiguous().map(|(name, correction)| {
            let refuse = move |_: &str| Err::<Value, _>(*correction);
            Arg::new(*name)
                .long(*name)
                .hide(true)
                .value_parser(ValueParser::new(refuse))
        });
        command.args(Named::all().map(flag)).args(hints)
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for AxisFlags {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        let mut flags = Self::default();
        flags.update_from_arg_matches(matches).map(|()| flags)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        self.0.clear();
        for named in Named::all() {
            let values = matches.get_many::<Value>(named.name());
            self.0
                .extend(values.into_iter().flatten().map(|value| AxisFlag {
                    flag: named.flag(),
                    axis: named.axis,
                    value: value.clone(),
                }));
        }
        Ok(())
    }
}
