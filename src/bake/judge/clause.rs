//! Clauses of verdicts, before they are joined into a sentence.

use std::fmt;

/// A clause of a verdict: a path from the general to the particular, such as `wrong: level 2: 25.0
/// % too bright: --scale 0.8`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Clause {
    path: Vec<String>,
    /// Whether it says what is left if the causes before it are fixed.
    pub is_remainder: bool,
}

impl Clause {
    pub fn new(text: impl Into<String>) -> Self {
        Self {
            path: vec![text.into()],
            is_remainder: false,
        }
    }

    /// Makes a clause with a detail, which may be left out.
    pub fn detailed(text: impl Into<String>, detail: impl Into<String>) -> Self {
        Self {
            path: vec![text.into(), detail.into()],
            is_remainder: false,
        }
    }

    pub fn remainder(text: impl Into<String>) -> Self {
        Self {
            is_remainder: true,
            ..Self::new(text)
        }
    }

    /// Puts the clause under a heading.
    pub fn under(mut self, heading: impl Into<String>) -> Self {
        self.path.insert(0, heading.into());
        self
    }

    /// Puts words before the clause.
    pub fn after(mut self, words: &str) -> Self {
        self.path[0].insert_str(0, words);
        self
    }
}

impl fmt::Display for Clause {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.path.join(": "))
    }
}

/// Changes the first clause.
pub fn with_first(mut clauses: Vec<Clause>, change: impl FnOnce(Clause) -> Clause) -> Vec<Clause> {
    if !clauses.is_empty() {
        let first = clauses.remove(0);
        clauses.insert(0, change(first));
    }
    clauses
}

/// Joins clauses into a sentence.
pub fn joined(clauses: &[Clause]) -> String {
    let texts: Vec<String> = clauses.iter().map(Clause::to_string).collect();
    texts.join("; ")
}
