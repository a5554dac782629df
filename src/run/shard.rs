//! The part of a run that one process does.

use std::fmt;
use std::str::FromStr;

const COUNT_MAX: usize = 10_000;

#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub struct Shard {
    /// From 1.
    pub index: usize,
    pub count: usize,
}

impl Shard {
    /// File stem, such as `2-of-4`.
    pub fn stem(self) -> String {
        format!("{}-of-{}", self.index, self.count)
    }

    pub fn by_stem(stem: &str) -> Option<Self> {
        stem.replace("-of-", "/").parse().ok()
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text
            .split_once('/')
            .and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)))
        {
            Some((index, count)) if (1..=count).contains(&index) && count <= COUNT_MAX => {
                Ok(Self { index, count })
            }
            _ => Err(format!(
                "expected K/N with 1 <= K <= N <= {COUNT_MAX}, such as 2/4"
            )),
        }
    }
}
