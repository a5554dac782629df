//! Numbers by the name of their column, small: a sweep holds each of them for thousands of cells.

use crate::metrics::{BiasVariance, METRICS};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::collections::BTreeMap;

/// A number that a JSON file gives back bit for bit: it is written as text, which may also be `inf`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(into = "String", try_from = "String")]
pub struct Exact(pub f64);

impl From<Exact> for String {
    fn from(number: Exact) -> Self {
        format!("{:e}", number.0)
    }
}

impl TryFrom<String> for Exact {
    type Error = std::num::ParseFloatError;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        text.parse().map(Self)
    }
}

/// Every name that a score can have, in the order of the columns.
fn names() -> impl Iterator<Item = &'static str> {
    METRICS.iter().map(|metric| metric.description().name).chain(BiasVariance::NAMES)
}

/// Scores by name, in the order of the columns. A sorted list takes half the memory of a tree.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scores(Box<[(&'static str, Exact)]>);

impl Scores {
    /// The score of that name.
    pub fn get(&self, name: &str) -> Option<&Exact> {
        self.0.iter().find(|(known, _)| *known == name).map(|(_, score)| score)
    }

    /// Names and scores.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, &Exact)> {
        self.0.iter().map(|(name, score)| (*name, score))
    }

    /// These and further scores.
    pub fn with(&self, more: &Self) -> Self {
        self.iter().chain(more.iter()).map(|(name, score)| (name, *score)).collect()
    }

    /// Whether every metric has a score. A record of another program may lack some.
    pub fn are_all(&self) -> bool {
        METRICS.iter().all(|metric| self.get(metric.description().name).is_some())
    }
}

/// Names that are none of this program's are left out.
impl<N: AsRef<str>> FromIterator<(N, Exact)> for Scores {
    fn from_iter<I: IntoIterator<Item = (N, Exact)>>(scores: I) -> Self {
        let given: Vec<(N, Exact)> = scores.into_iter().collect();
        let of = |name: &'static str| {
            let score = given.iter().rev().find(|(given, _)| given.as_ref() == name)?.1;
            Some((name, score))
        };
        Self(names().filter_map(of).collect())
    }
}

impl Serialize for Scores {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.iter())
    }
}

impl<'de> Deserialize<'de> for Scores {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Ok(BTreeMap::<String, Exact>::deserialize(deserializer)?.into_iter().collect())
    }
}
