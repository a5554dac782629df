//! Numbers by name, small: a sweep of thousands of cells holds each name thousands of times.

use super::store::Exact;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// A name of a metric or column: one thin pointer. The text lives as long as the process; there are a few dozen.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
struct Name(&'static &'static str);

static KNOWN: Mutex<BTreeMap<&'static str, Name>> = Mutex::new(BTreeMap::new());

impl From<&str> for Name {
    fn from(text: &str) -> Self {
        // A thread that panicked left a whole map: names are added in one step.
        let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(name) = known.get(text) {
            return *name;
        }
        let text: &'static str = Box::leak(text.into());
        let name = Self(Box::leak(Box::new(text)));
        known.insert(text, name);
        name
    }
}

/// Scores by name, in the order of the names. A sorted list takes half the memory of a tree.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scores(Box<[(Name, Exact)]>);

impl Scores {
    /// The score of that name.
    pub fn get(&self, name: &str) -> Option<&Exact> {
        let index = self.0.binary_search_by(|(known, _)| (*known.0).cmp(name)).ok()?;
        Some(&self.0[index].1)
    }

    /// Names and scores in the order of the names.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, &Exact)> {
        self.0.iter().map(|(name, score)| (*name.0, score))
    }

    /// These and further scores.
    pub fn with(&self, more: &Self) -> Self {
        self.iter().chain(more.iter()).map(|(name, score)| (name, *score)).collect()
    }
}

impl<N: AsRef<str>> FromIterator<(N, Exact)> for Scores {
    fn from_iter<I: IntoIterator<Item = (N, Exact)>>(scores: I) -> Self {
        let by_name: BTreeMap<Name, Exact> = scores.into_iter().map(|(n, x)| (Name::from(n.as_ref()), x)).collect();
        Self(by_name.into_iter().collect())
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
