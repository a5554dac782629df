//! Statements as data, and the one place that writes them: as Markdown for files and terminals, as
//! spans for the page.

use super::markdown::significant;
use super::variant::Variant;
use serde::Serialize;
use std::fmt;

/// Significant digits of a number in a sentence.
const DIGITS: usize = 2;

/// A number with the form in which it is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Number {
    /// With some significant digits: "0.012".
    Rounded { value: f64, digits: usize },
    /// A share of 1 in percent, with some significant digits: "25 %" for 0.25.
    Share { share: f64, digits: usize },
    /// "16".
    Count(u64),
    /// A bound: fewer were not tried. "at most 4".
    AtMost(u64),
    /// A bound: more were not tried. "more than 256".
    MoreThan(u64),
}

impl Number {
    pub fn rounded(value: f64) -> Self {
        Self::Rounded {
            value,
            digits: DIGITS,
        }
    }

    pub fn share(share: f64) -> Self {
        Self::Share {
            share,
            digits: DIGITS,
        }
    }
}

impl Number {
    /// Whether a noun after it is singular: "1 sample", "at most 1 sample", but "1.0 samples".
    fn is_one(self) -> bool {
        matches!(self, Self::Count(1) | Self::AtMost(1) | Self::MoreThan(1))
    }
}

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match *self {
            Self::Rounded { value, digits } => f.write_str(&significant(value, digits)),
            Self::Share { share, digits } => write!(f, "{} %", significant(100.0 * share, digits)),
            Self::Count(count) => write!(f, "{count}"),
            Self::AtMost(count) => write!(f, "at most {count}"),
            Self::MoreThan(count) => write!(f, "more than {count}"),
        }
    }
}

/// One number, or the least and the largest of several.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    pub least: Number,
    pub most: Number,
}

impl Extent {
    /// The extent of positive numbers.
    pub fn from_values(values: impl IntoIterator<Item = f64>) -> Self {
        let mut least = f64::INFINITY;
        let mut most = 0.0;
        for value in values {
            least = f64::min(least, value);
            most = f64::max(most, value);
        }
        Self {
            least: Number::rounded(least),
            most: Number::rounded(most),
        }
    }

    /// Whether both ends read alike.
    fn is_single(&self) -> bool {
        self.least.to_string() == self.most.to_string()
    }
}

impl From<Number> for Extent {
    fn from(number: Number) -> Self {
        Self {
            least: number,
            most: number,
        }
    }
}

impl fmt::Display for Extent {
    /// "8.1 to 17", or one number if both ends read alike.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        if self.is_single() {
            write!(f, "{}", self.least)
        } else {
            write!(f, "{} to {}", self.least, self.most)
        }
    }
}

/// What the ends of an interval are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coverage {
    /// A 95 % interval.
    Confidence,
    /// The least and the largest of all; the plural says of what: "environments".
    All(&'static str),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    pub extent: Extent,
    pub coverage: Coverage,
}

impl fmt::Display for Interval {
    /// " (95 % 8.1 to 17)"; empty if both ends read alike.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        if self.extent.is_single() {
            return Ok(());
        }
        match self.coverage {
            Coverage::Confidence => write!(f, " (95 % {})", self.extent),
            Coverage::All(plural) => write!(f, " ({plural} {})", self.extent),
        }
    }
}

/// What is counted or measured: written after a number, with the blank before it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Unit {
    /// After the count 1, and after a bound of 1.
    pub one: &'static str,
    /// After other numbers.
    pub many: &'static str,
}

impl Unit {
    pub const SAMPLES: Self = Self {
        one: " sample",
        many: " samples",
    };
    pub const SAMPLES_PER_PIXEL: Self = Self {
        one: " sample per pixel",
        many: " samples per pixel",
    };
    pub const FRAMES: Self = Self {
        one: " frame",
        many: " frames",
    };

    fn after(self, extent: &Extent) -> &'static str {
        if extent.is_single() && extent.most.is_one() {
            self.one
        } else {
            self.many
        }
    }
}

impl From<&'static str> for Unit {
    /// A unit without a plural: " ms", " %".
    fn from(unit: &'static str) -> Self {
        Self {
            one: unit,
            many: unit,
        }
    }
}

/// A measured number with its unit and its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantity {
    pub extent: Extent,
    pub unit: Unit,
    pub interval: Option<Interval>,
    /// Whether the number and its unit are emphasised.
    pub is_strong: bool,
}

impl Quantity {
    pub fn new(extent: impl Into<Extent>) -> Self {
        Self {
            extent: extent.into(),
            unit: Unit::default(),
            interval: None,
            is_strong: false,
        }
    }

    /// A number with two significant digits.
    pub fn rounded(value: f64) -> Self {
        Self::new(Number::rounded(value))
    }

    pub fn unit(self, unit: impl Into<Unit>) -> Self {
        Self {
            unit: unit.into(),
            ..self
        }
    }

    pub fn interval(self, interval: Option<Interval>) -> Self {
        Self { interval, ..self }
    }

    pub fn strong(self) -> Self {
        Self {
            is_strong: true,
            ..self
        }
    }

    fn number_and_unit(&self) -> String {
        format!("{}{}", self.extent, self.unit.after(&self.extent))
    }

    fn interval_text(&self) -> String {
        self.interval
            .map_or_else(String::new, |interval| interval.to_string())
    }
}

impl fmt::Display for Quantity {
    /// Without emphasis: "12 (95 % 8.1 to 17)".
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.number_and_unit())?;
        f.write_str(&self.interval_text())
    }
}

#[derive(Clone, Debug, PartialEq)]
pub enum Phrase {
    Words(String),
    Quantity(Quantity),
    Method(Variant),
    Metric(&'static str),
    /// A value on an axis of the experiment, labelled: "alpha 0.25".
    AxisValue {
        axis: &'static str,
        label: String,
    },
    /// Another name in code: a scene, a setting, a command.
    Code(String),
    Strong(Statement),
}

/// A sentence of typed parts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Statement(Vec<Phrase>);

/// Makes a [`Statement`] of its parts, in order: texts, quantities, [`Phrase`]s, other statements,
/// and options of these.
macro_rules! statement {
    ($($part:expr),* $(,)?) => {{
        let mut statement = $crate::draw::words::Statement::default();
        $(statement.push($part);)*
        statement
    }};
}

pub(crate) use statement;

impl Statement {
    pub fn push(&mut self, parts: impl Into<Self>) {
        self.0.extend(parts.into().0);
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The statement as an emphasised group.
    pub fn strong(self) -> Self {
        Phrase::Strong(self).into()
    }

    /// These statements with a separator between them.
    pub fn joined(statements: impl IntoIterator<Item = Self>, separator: &str) -> Self {
        let mut all = Self::default();
        for (index, statement) in statements.into_iter().enumerate() {
            if index > 0 {
                all.push(separator);
            }
            all.push(statement);
        }
        all
    }

    /// "a", "a and b", "a, b and c"; of more than four, the first three and "others".
    pub fn listed(mut items: Vec<Self>) -> Self {
        if items.len() > 4 {
            items.truncate(3);
            items.push("others".into());
        }
        let Some(last) = items.pop() else {
            return Self::default();
        };
        if items.is_empty() {
            return last;
        }
        statement![Self::joined(items, ", "), " and ", last]
    }
}

impl From<Phrase> for Statement {
    fn from(part: Phrase) -> Self {
        Self(vec![part])
    }
}

impl From<&str> for Statement {
    fn from(words: &str) -> Self {
        words.to_owned().into()
    }
}

impl From<String> for Statement {
    fn from(words: String) -> Self {
        if words.is_empty() {
            Self::default()
        } else {
            Phrase::Words(words).into()
        }
    }
}

impl From<Quantity> for Statement {
    fn from(quantity: Quantity) -> Self {
        Phrase::Quantity(quantity).into()
    }
}

impl From<Number> for Statement {
    fn from(number: Number) -> Self {
        Quantity::new(number).into()
    }
}

impl<T: Into<Statement>> From<Option<T>> for Statement {
    fn from(parts: Option<T>) -> Self {
        parts.map_or_else(Self::default, T::into)
    }
}

/// The statements as one paragraph of Markdown.
pub fn markdown<'s>(statements: impl IntoIterator<Item = &'s Statement>) -> String {
    let mut text = String::new();
    let mut is_strong = false;
    for piece in paragraph(statements) {
        if piece.is_strong != is_strong {
            text += "**";
            is_strong = piece.is_strong;
        }
        text += &piece.markdown();
    }
    if is_strong {
        text += "**";
    }
    text
}

/// As [`markdown`], without emphasis: for text that is emphasised as a whole.
pub fn plain_markdown<'s>(statements: impl IntoIterator<Item = &'s Statement>) -> String {
    let pieces = paragraph(statements);
    pieces.iter().map(Piece::markdown).collect()
}

/// Text of the page in one style.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Span {
    pub text: String,
    pub is_strong: bool,
    /// Whether the text is the title of a method, whose name is `code`.
    pub is_method: bool,
    /// The name in code, if it is one.
    pub code: Option<String>,
}

/// The statements as one paragraph of the page, with methods by their titles.
pub fn spans<'s>(statements: impl IntoIterator<Item = &'s Statement>) -> Vec<Span> {
    let pieces = paragraph(statements);
    let mut spans = Vec::with_capacity(pieces.len());
    for piece in pieces {
        let title = piece.method.map(|variant| variant.title());
        let title = title.filter(|title| *title != piece.text);
        spans.push(Span {
            is_strong: piece.is_strong,
            is_method: title.is_some(),
            code: piece.is_code.then(|| piece.text.clone()),
            text: match title {
                Some(title) if spans.is_empty() => title,
                Some(title) => title[..1].to_lowercase() + &title[1..],
                None => piece.text,
            },
        });
    }
    spans
}

/// Text in one style.
struct Piece {
    text: String,
    is_strong: bool,
    is_code: bool,
    method: Option<Variant>,
}

impl Piece {
    /// Without emphasis.
    fn markdown(&self) -> String {
        if self.is_code {
            format!("`{}`", self.text)
        } else {
            self.text.clone()
        }
    }
}

/// The statements in order, with a blank between two; neighbours in one style are one piece.
fn paragraph<'s>(statements: impl IntoIterator<Item = &'s Statement>) -> Vec<Piece> {
    let mut pieces = Pieces::default();
    for (index, statement) in statements.into_iter().enumerate() {
        if index > 0 {
            pieces.words(" ", false);
        }
        pieces.statement(statement, false);
    }
    pieces.0
}

#[derive(Default)]
struct Pieces(Vec<Piece>);

impl Pieces {
    fn statement(&mut self, statement: &Statement, is_strong: bool) {
        for part in &statement.0 {
            match part {
                Phrase::Words(text) | Phrase::AxisValue { label: text, .. } => {
                    self.words(text, is_strong);
                }
                Phrase::Quantity(quantity) => {
                    self.words(&quantity.number_and_unit(), is_strong || quantity.is_strong);
                    self.words(&quantity.interval_text(), is_strong);
                }
                Phrase::Method(variant) => {
                    self.code(&variant.to_string(), is_strong, Some(variant.clone()));
                }
                Phrase::Metric(name) => self.code(name, is_strong, None),
                Phrase::Code(text) => self.code(text, is_strong, None),
                Phrase::Strong(group) => self.statement(group, true),
            }
        }
    }

    fn words(&mut self, text: &str, is_strong: bool) {
        match self.0.last_mut() {
            _ if text.is_empty() => {}
            Some(last) if !last.is_code && last.is_strong == is_strong => last.text += text,
            _ => self.0.push(Piece {
                text: text.to_owned(),
                is_strong,
                is_code: false,
                method: None,
            }),
        }
    }

    fn code(&mut self, text: &str, is_strong: bool, method: Option<Variant>) {
        self.0.push(Piece {
            text: text.to_owned(),
            is_strong,
            is_code: true,
            method,
        });
    }
}

#[cfg(test)]
mod tests;
