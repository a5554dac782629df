//! TOML with places: walking the parsed tree without stopping at the first fault.

use super::axis::named::hint;
use super::fault::{Faults, Place};
use super::value::{Kind, Raw, Value};
use serde::Deserialize;
use toml::Spanned;
use toml::de::{DeTable, DeValue, ValueDeserializer};
use toml_parser::parser::{Event, RecursionGuard, parse_document};

/// Levels of nested brackets, as the crate `toml` allows them.
const DEPTH_MAX: u32 = 80;

/// A key, its value and the place of the key.
pub type Entry<'t, 'i> = (&'t str, &'t Spanned<DeValue<'i>>, Place);

/// The tree of a text; what the parser has against it are faults. Where a bracket is not closed, that is the fault: the tree ends before its
/// line, since a parser finds all sorts of things behind it.
pub fn parsed<'t>(text: &'t str, faults: &mut Faults) -> Spanned<DeTable<'t>> {
    let mut errors = Vec::new();
    let mut ignored = |_: Event| {};
    let mut receiver = RecursionGuard::new(&mut ignored, DEPTH_MAX);
    parse_document(&toml_parser::Source::new(text).lex().into_vec(), &mut receiver, &mut errors);
    let line_start = |at: usize| text[..at].rfind('\n').map_or(0, |newline| newline + 1);
    let unclosed = errors.iter().filter(|error| error.description().starts_with("unclosed"));
    let mut end = text.len();
    // The first line that has one. Of two in a line the inner one, which the parser names first: it swallows what closes the outer one.
    if let Some(open) = unclosed.filter_map(|error| error.context()).min_by_key(|open| line_start(open.start())) {
        let [open_with, close] = if text[open.start()..].starts_with('{') { ["{", "}"] } else { ["[", "]"] };
        let fault = format!("not TOML: {open_with} is not closed; expected {close}");
        faults.add(&Place::File(open.start()), fault);
        end = line_start(open.start());
    }
    let (root, errors) = DeTable::parse_recoverable(&text[..end]);
    for error in &errors {
        let span = error.span().unwrap_or_default();
        faults.add_with(&Place::File(span.start), || match (error.message(), text.get(span.clone())) {
            ("duplicate key", Some(key)) => format!("not TOML: the key {key} is written twice"),
            (message, _) if message.contains("recurs") => format!("not TOML: nested deeper than {DEPTH_MAX} levels"),
            (message, _) => format!("not TOML: {message}"),
        });
    }
    root
}

/// Where a value was written.
pub fn at(value: &Spanned<DeValue>) -> Place {
    Place::File(value.span().start)
}

/// Notes a key that is none of `known`, with the likely one of them.
pub fn unknown_key(place: &Place, prefix: &str, key: &str, known: &[&str], faults: &mut Faults) {
    faults.add_with(place, || {
        format!("{prefix}{key} is unknown{}; expected one of {}", hint(key, known), known.join(", "))
    });
}

/// The value that `kind` makes of what is written, or a fault at its place.
pub fn checked(kind: Kind, name: &str, value: &Spanned<DeValue>, faults: &mut Faults) -> Option<Value> {
    checked_as(|raw| kind.parse(raw), name, value, faults)
}

/// As [`checked`], with any way to read the value.
pub fn checked_as<T>(
    parse: impl Fn(&Raw) -> Result<T, String>,
    name: &str,
    value: &Spanned<DeValue>,
    faults: &mut Faults,
) -> Option<T> {
    parse(&raw(value)).map_err(|fault| faults.add(&at(value), format!("{name}: {fault}"))).ok()
}

/// The entries of a table in the order of the file, with the place of each key.
pub fn entries<'t, 'i>(table: &'t DeTable<'i>) -> Vec<Entry<'t, 'i>> {
    let mut entries: Vec<_> =
        table.iter().map(|(key, value)| (key.span().start, key.get_ref().as_ref(), value)).collect();
    entries.sort_by_key(|(offset, ..)| *offset);
    entries.into_iter().map(|(offset, key, value)| (key, value, Place::File(offset))).collect()
}

/// The entries of a value that must be a table.
pub fn table<'t, 'i>(value: &'t Spanned<DeValue<'i>>, name: &str, faults: &mut Faults) -> Vec<Entry<'t, 'i>> {
    match value.get_ref() {
        DeValue::Table(table) => entries(table),
        _ => {
            faults.add(&at(value), format!("{name}: {} is not a table", raw(value)));
            Vec::new()
        }
    }
}

/// As [`table`], of one that knows these keys only.
pub fn section<'t, 'i>(
    value: &'t Spanned<DeValue<'i>>,
    name: &str,
    keys: &[&str],
    faults: &mut Faults,
) -> Vec<Entry<'t, 'i>> {
    let mut entries = table(value, name, faults);
    entries.retain(|(key, _, place)| {
        let is_known = keys.contains(key);
        if !is_known {
            unknown_key(place, &format!("{name}."), key, keys, faults);
        }
        is_known
    });
    entries
}

/// The items of a value that must be a list, written `[[name]]`.
pub fn list<'t, 'i>(value: &'t Spanned<DeValue<'i>>, name: &str, faults: &mut Faults) -> Vec<&'t Spanned<DeValue<'i>>> {
    match value.get_ref() {
        DeValue::Array(items) => items.iter().collect(),
        _ => {
            faults.add(&at(value), format!("{name}: write [[{name}]] for each one"));
            Vec::new()
        }
    }
}

/// The value as written, before it is checked. A whole number of more than 64 bits is infinite.
pub fn raw(value: &Spanned<DeValue>) -> Raw {
    Raw::deserialize(ValueDeserializer::from(value.clone())).unwrap_or(Raw::Float(f64::INFINITY))
}
