//! A method with its sample count, by code name and by title.

use crate::base::csv::{Cell, NameAndLabel};
use crate::base::names::Listed;
use crate::instrument::shade::{Method, NONE, REFERENCE};
use std::fmt;

/// The method whose code name is short enough for a label if it has no sample count.
const SAMPLED: &str = "sampled";

/// What makes an image: a method, at one sample count if it takes samples.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Variant {
    /// Code name of a specular method, or of a diffuse one where diffuse methods are compared.
    pub method: String,
    /// Samples per pixel.
    pub samples: Option<u32>,
}

impl Variant {
    /// A method without a sample count.
    pub fn new(method: impl Into<String>) -> Self {
        Self {
            method: method.into(),
            samples: None,
        }
    }

    /// For sentences of a page: "Split sum (textbook)", "Sampling, 16 samples". Methods without a
    /// title, which are diffuse, keep their code name.
    pub fn title(&self) -> String {
        Method::by_name(&self.method)
            .map_or_else(|| self.to_string(), |method| method.words(self.samples))
    }

    /// For figures and tables of a page: the title, but short code names that are words already
    /// stay: `none`, `reference 64`, and `sampled` without a count.
    pub fn label(&self) -> String {
        let is_word = [NONE, REFERENCE].contains(&self.method.as_str())
            || (self.method == SAMPLED && self.samples.is_none());
        if is_word {
            self.to_string()
        } else {
            self.title()
        }
    }
}

impl fmt::Display for Variant {
    /// For files and terminals: "split-sum", "sampled 16".
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.method)?;
        match self.samples {
            Some(count) => write!(f, " {count}"),
            None => Ok(()),
        }
    }
}

impl From<&Variant> for Cell {
    fn from(variant: &Variant) -> Self {
        let name = NameAndLabel {
            name: variant.to_string(),
            label: variant.label(),
        };
        name.into()
    }
}

#[cfg(test)]
mod tests;
