//! Parsers whose names shells complete. The lists of names decide and write the messages, as in
//! experiment files.

use clap::builder::{PossibleValue, TypedValueParser};
use clap::{Arg, Command, Error};
use splitsum::base::names::Listed;
use std::ffi::OsStr;

/// A parser, and the names that completions offer for it.
#[derive(Clone)]
pub struct Completed<P> {
    parser: P,
    /// Empty if other values are allowed.
    names: Vec<&'static str>,
}

/// Finds an entry of a list by its name.
type Find<T> = fn(&str) -> Result<&'static T, String>;

/// Parses the name of a list's entry.
pub fn listed<T: Listed + ?Sized>() -> Completed<Find<T>> {
    Completed::new(T::parse, T::names())
}

impl<P> Completed<P> {
    pub fn new(parser: P, names: Vec<&'static str>) -> Self {
        Self { parser, names }
    }
}

impl<P: TypedValueParser> TypedValueParser for Completed<P> {
    type Value = P::Value;

    fn parse_ref(
        &self,
        command: &Command,
        arg: Option<&Arg>,
        value: &OsStr,
    ) -> Result<Self::Value, Error> {
        self.parser.parse_ref(command, arg, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        if self.names.is_empty() {
            return None;
        }
        Some(Box::new(self.names.iter().copied().map(PossibleValue::new)))
    }
}

#[cfg(test)]
mod tests {
    use super::listed;
    use crate::cli::flags::AxisFlags;
    use clap::builder::{PossibleValue, TypedValueParser};
    use clap::{Args, Command};
    use splitsum::base::names::Listed;
    use splitsum::instrument::brdf::MaskingShadowing;

    fn names(values: impl IntoIterator<Item = PossibleValue>) -> Vec<String> {
        let values = values.into_iter();
        values.map(|value| value.get_name().to_owned()).collect()
    }

    #[test]
    fn completions_offer_the_names_of_lists() {
        let parser = listed::<MaskingShadowing>();
        let offered = names(parser.possible_values().expect("a list has names"));
        assert_eq!(offered, MaskingShadowing::names());
        // Of flags that are made from axes, those whose values are names alone.
        let command = AxisFlags::augment_args(Command::new("render"));
        let offered = |flag: &str| {
            let mut flags = command.get_arguments();
            let flag = flags.find(|arg| arg.get_long() == Some(flag));
            names(flag.expect("a flag of render").get_possible_values())
        };
        assert_eq!(offered("masking"), MaskingShadowing::names());
        assert!(offered("method").is_empty(), "a file is allowed");
        assert!(offered("alpha").is_empty(), "a number");
    }
}
