//! TOML with places: walks the parsed tree without stopping at the first fault.

use super::axis::named::{LISTED_AXES, hint};
use super::fault::{Faults, Location};
use super::value::{Kind, Raw, Value};
use crate::base::names::expected;
use serde::Deserialize;
use toml::Spanned;
use toml::de::{DeTable, DeValue, ValueDeserializer};
use toml_parser::parser::{Event, RecursionGuard, parse_document};

/// Deepest nesting of brackets that the crate `toml` parses.
const DEPTH_MAX: u32 = 80;

pub type Entry<'t, 'i> = (&'t str, &'t Spanned<DeValue<'i>>, Location);

/// Parses a text; syntax errors become faults. At the first unclosed bracket the tree ends, since
/// errors behind it mislead.
pub fn parsed<'t>(text: &'t str, faults: &mut Faults) -> Spanned<DeTable<'t>> {
    let mut errors = Vec::new();
    let mut ignored = |_: Event| {};
    let mut receiver = RecursionGuard::new(&mut ignored, DEPTH_MAX);
    parse_document(
        &toml_parser::Source::new(text).lex().into_vec(),
        &mut receiver,
        &mut errors,
    );
    let line_start = |at: usize| text[..at].rfind('\n').map_or(0, |newline| newline + 1);
    let unclosed = errors
        .iter()
        .filter(|error| error.description().starts_with("unclosed"));
    let mut end = text.len();
    // If a line has two, the parser names the inner one first.
    if let Some(open) = unclosed
        .filter_map(|error| error.context())
        .min_by_key(|open| line_start(open.start()))
    {
        let [open_with, close] = if text[open.start()..].starts_with('{') {
            ["{", "}"]
        } else {
            ["[", "]"]
        };
        let fault = format!("not TOML: {open_with} is not closed; expected {close}");
        faults.add(&Location::File(open.start()), fault);
        end = line_start(open.start());
    }
    let (root, errors) = DeTable::parse_recoverable(&text[..end]);
    for error in &errors {
        let span = error.span().unwrap_or_default();
        faults.add_with(&Location::File(span.start), || {
            match (error.message(), text.get(span.clone())) {
                ("duplicate key", Some(key)) => format!("not TOML: the key {key} is written twice"),
                (message, _) if message.contains("recurs") => {
                    format!("not TOML: nested deeper than {DEPTH_MAX} levels")
                }
                (message, _) => format!("not TOML: {message}"),
            }
        });
    }
    root
}

pub fn start_of(value: &Spanned<DeValue>) -> Location {
    Location::File(value.span().start)
}

/// Reports an unknown key with the nearest known one.
pub fn unknown_key(
    location: &Location,
    prefix: &str,
    key: &str,
    known: &[&str],
    faults: &mut Faults,
) {
    let listed_in = if prefix.is_empty() {
        "a key of experiments/README.md"
    } else {
        LISTED_AXES
    };
    faults.add_with(location, || {
        let near = Some(hint(key, known)).filter(|near| !near.is_empty());
        format!(
            "{prefix}{key} is unknown{}",
            near.unwrap_or_else(|| format!("; expected {}", expected(known, Some(listed_in))))
        )
    });
}

/// Parses a value as `kind`, or reports a fault at its location.
pub fn checked(
    kind: Kind,
    name: &str,
    value: &Spanned<DeValue>,
    faults: &mut Faults,
) -> Option<Value> {
    checked_as(|raw| kind.parse(raw), name, value, faults)
}

/// Parses a value by a function, or reports a fault at its location.
pub fn checked_as<T>(
    parse: impl Fn(&Raw) -> Result<T, String>,
    name: &str,
    value: &Spanned<DeValue>,
    faults: &mut Faults,
) -> Option<T> {
    parse(&raw(value))
        .map_err(|fault| faults.add(&start_of(value), format!("{name}: {fault}")))
        .ok()
}

/// Reads text; empty after a fault.
pub fn text(name: &str, value: &Spanned<DeValue>, faults: &mut Faults) -> String {
    let text = |raw: &Raw| {
        raw.as_str()
            .map(str::to_owned)
            .ok_or_else(|| format!("{raw} is not text"))
    };
    checked_as(text, name, value, faults).unwrap_or_default()
}

/// Lists the entries of a table in the order of the file, with the location of each key.
pub fn entries<'t, 'i>(table: &'t DeTable<'i>) -> Vec<Entry<'t, 'i>> {
    let mut entries: Vec<_> = table
        .iter()
        .map(|(key, value)| (key.span().start, key.get_ref().as_ref(), value))
        .collect();
    entries.sort_by_key(|(offset, ..)| *offset);
    entries
        .into_iter()
        .map(|(offset, key, value)| (key, value, Location::File(offset)))
        .collect()
}

/// Lists the entries of a value, which must be a table.
pub fn table<'t, 'i>(
    value: &'t Spanned<DeValue<'i>>,
    name: &str,
    faults: &mut Faults,
) -> Vec<Entry<'t, 'i>> {
    match value.get_ref() {
        DeValue::Table(table) => entries(table),
        _ => {
            faults.add(
                &start_of(value),
                format!("{name}: {} is not a table", raw(value)),
            );
            Vec::new()
        }
    }
}

/// Lists the entries with known keys and reports the others.
pub fn section<'t, 'i>(
    value: &'t Spanned<DeValue<'i>>,
    name: &str,
    keys: &[&str],
    faults: &mut Faults,
) -> Vec<Entry<'t, 'i>> {
    let mut entries = table(value, name, faults);
    entries.retain(|(key, _, location)| {
        let is_known = keys.contains(key);
        if !is_known {
            unknown_key(location, &format!("{name}."), key, keys, faults);
        }
        is_known
    });
    entries
}

/// Lists the items of a value written as `[[name]]`.
pub fn list<'t, 'i>(
    value: &'t Spanned<DeValue<'i>>,
    name: &str,
    faults: &mut Faults,
) -> Vec<&'t Spanned<DeValue<'i>>> {
    match value.get_ref() {
        DeValue::Array(items) => items.iter().collect(),
        _ => {
            faults.add(
                &start_of(value),
                format!("{name}: write [[{name}]] for each one"),
            );
            Vec::new()
        }
    }
}

/// Converts a value; whole numbers above 64 bits become infinite.
pub fn raw(value: &Spanned<DeValue>) -> Raw {
    Raw::deserialize(ValueDeserializer::from(value.clone())).unwrap_or(Raw::Float(f64::INFINITY))
}
