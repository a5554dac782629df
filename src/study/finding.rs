//! The answer to a question, as data.

use super::table::Table;
use crate::draw::figure::Figure;
use crate::draw::words::{self, Statement};

#[derive(Clone, Debug)]
pub struct Finding {
    pub sentences: Sentences,
    pub table: Table,
    /// A few rows for people; by default the table.
    pub digest: Option<Table>,
    pub figure: Option<Figure>,
}

/// One to three sentences of at most 25 words. Each of their numbers is in the table or the digest.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sentences {
    /// The answer in one sentence.
    pub headline: Statement,
    /// What changes the answer: extremes, exceptions, alternatives.
    pub details: Vec<Statement>,
    /// What the numbers cover: cases, and how views count.
    pub scope: Vec<Statement>,
}

impl Sentences {
    pub fn new(headline: Statement) -> Self {
        Self {
            headline,
            ..Self::default()
        }
    }

    pub fn with_details(self, details: impl IntoIterator<Item = Statement>) -> Self {
        Self {
            details: details.into_iter().collect(),
            ..self
        }
    }

    pub fn with_scope(self, scope: impl IntoIterator<Item = Statement>) -> Self {
        Self {
            scope: scope.into_iter().collect(),
            ..self
        }
    }

    /// All sentences, in order.
    pub fn all(&self) -> impl Iterator<Item = &Statement> {
        std::iter::once(&self.headline).chain(self.after_headline())
    }

    pub fn after_headline(&self) -> impl Iterator<Item = &Statement> {
        self.details.iter().chain(&self.scope)
    }

    /// All sentences as one paragraph of Markdown.
    pub fn markdown(&self) -> String {
        words::markdown(self.all())
    }

    /// As [`Self::markdown`], without emphasis.
    pub fn plain_markdown(&self) -> String {
        words::plain_markdown(self.all())
    }
}
