//! TOML with places: walking the parsed tree without stopping at the first fault.

use super::fault::{Faults, Place};
use super::value::{Kind, Raw, Value};
use crate::spelling::suggestion;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A key, its value and the place of the key.
pub type Entry<'t, 'i> = (&'t str, &'t Spanned<DeValue<'i>>, Place);

/// Notes a key that is none of `known`, with the nearest of them.
pub fn unknown_key(place: &Place, prefix: &str, key: &str, known: &[&str], faults: &mut Faults) {
    faults.add_with(place, |_| {
        format!("{prefix}{key} is unknown{}; expected one of {}", suggestion(key, known), known.join(", "))
    });
}

/// The value that `kind` makes of what is written, or a fault at its place.
pub fn checked(kind: Kind, name: &str, value: &Spanned<DeValue>, faults: &mut Faults) -> Option<Value> {
    checked_as(|raw| kind.parse(raw), name, value, faults)
}

/// As [`checked`], with any way to read the value.
pub fn checked_as(
    parse: impl Fn(&Raw) -> Result<Value, String>,
    name: &str,
    value: &Spanned<DeValue>,
    faults: &mut Faults,
) -> Option<Value> {
    parse(&raw(value.get_ref()))
        .map_err(|fault| faults.add(&Place::File(value.span().start), format!("{name}: {fault}")))
        .ok()
}

/// The entries of a table in the order of the file, with the place of each key.
pub fn entries<'t, 'i>(table: &'t DeTable<'i>) -> Vec<Entry<'t, 'i>> {
    let mut entries: Vec<_> =
        table.iter().map(|(key, value)| (key.span().start, key.get_ref().as_ref(), value)).collect();
    entries.sort_by_key(|(offset, ..)| *offset);
    entries.into_iter().map(|(offset, key, value)| (key, value, Place::File(offset))).collect()
}

/// The parser's message for a key that stands twice in one table.
const TWICE: &str = "duplicate key";

/// For the parser's fault of a second key, that key and where the first one is: the nearest before it of that name, and for a table's header
/// the nearest header.
pub fn first_of_twice<'t>(
    root: &DeTable,
    text: &'t str,
    second: &Range<usize>,
    message: &str,
) -> Option<(&'t str, usize)> {
    let key = text.get(second.clone()).filter(|_| message == TWICE)?;
    let line_start = text[..second.start].rfind('\n').map_or(0, |i| i + 1);
    if text[line_start..second.start].trim_start().starts_with('[') {
        let header =
            |line: &str| line.trim_start().trim_start_matches('[').split(']').next().map(|name| name.trim() == key);
        let starts = text[..line_start].match_indices('\n').map(|(i, _)| i + 1);
        let is_header = |start: &usize| {
            let line = text[*start..].lines().next().unwrap_or_default();
            line.trim_start().starts_with('[') && header(line) == Some(true)
        };
        return Some((key, std::iter::once(0).chain(starts).filter(|start| *start < line_start).rfind(is_header)?));
    }
    let mut places = Vec::new();
    places_of(root, key.trim_matches(['"', '\'']), &mut places);
    Some((key, places.into_iter().filter(|place| *place < second.start).max()?))
}

/// Where keys of that name are, in all tables.
fn places_of(table: &DeTable, name: &str, places: &mut Vec<usize>) {
    for (key, value) in table.iter() {
        if key.get_ref() == name {
            places.push(key.span().start);
        }
        let items = value.get_ref().as_array().into_iter().flatten().filter_map(|item| item.get_ref().as_table());
        value.get_ref().as_table().into_iter().chain(items).for_each(|inner| places_of(inner, name, places));
    }
}

/// Where brackets, and texts of several lines, open that nothing closes: the place of each, and what closes it.
pub fn unclosed(text: &str) -> Vec<(usize, &'static str)> {
    let mut open: Vec<(usize, &str)> = Vec::new();
    let mut found: Vec<(usize, &str)> = Vec::new();
    let mut at = 0;
    while let Some(c) = text[at..].chars().next() {
        let rest = &text[at..];
        let quotes = ["\"\"\"", "'''", "\"", "'"].into_iter().find(|quotes| rest.starts_with(quotes));
        match (c, quotes) {
            ('#', _) => at += rest.find('\n').unwrap_or(rest.len()),
            (_, Some(quotes)) => match text_length(rest, quotes) {
                Some(length) => at += length,
                None => {
                    open.push((at, quotes));
                    break;
                }
            },
            _ => {
                match c {
                    '[' => open.push((at, "]")),
                    '{' => open.push((at, "}")),
                    ']' | '}' => {
                        // What opened after the partner of this one is not closed.
                        if let Some(partner) = open.iter().rposition(|(_, close)| close.starts_with(c)) {
                            found.extend(open.drain(partner..).skip(1));
                        }
                    }
                    _ => {}
                }
                at += c.len_utf8();
            }
        }
    }
    found.extend(open);
    found
}

/// Bytes of the text that `rest` begins with, its quotes included. One of a single line ends with the line; `None` for a longer one without end.
fn text_length(rest: &str, quotes: &str) -> Option<usize> {
    let mut at = quotes.len();
    while let Some(c) = rest[at..].chars().next() {
        match c {
            '\\' if quotes.starts_with('"') => at += 1 + rest[at + 1..].chars().next().map_or(0, char::len_utf8),
            '\n' if quotes.len() == 1 => return Some(at),
            _ if rest[at..].starts_with(quotes) => return Some(at + quotes.len()),
            _ => at += c.len_utf8(),
        }
    }
    (quotes.len() == 1).then_some(rest.len())
}

/// The entries of a value that must be a table.
pub fn table<'t, 'i>(value: &'t Spanned<DeValue<'i>>, name: &str, faults: &mut Faults) -> Vec<Entry<'t, 'i>> {
    match value.get_ref() {
        DeValue::Table(table) => entries(table),
        other => {
            faults.add(&Place::File(value.span().start), format!("{name}: {} is not a table", raw(other)));
            Vec::new()
        }
    }
}

/// The items of a value that must be a list, written `[[name]]`.
pub fn list<'t, 'i>(value: &'t Spanned<DeValue<'i>>, name: &str, faults: &mut Faults) -> Vec<&'t Spanned<DeValue<'i>>> {
    match value.get_ref() {
        DeValue::Array(items) => items.iter().collect(),
        _ => {
            faults.add(&Place::File(value.span().start), format!("{name}: write [[{name}]] for each one"));
            Vec::new()
        }
    }
}

/// The texts of a list of distinct ones, each with its place; an empty list is a fault.
pub fn texts(value: &Spanned<DeValue>, name: &str, faults: &mut Faults) -> Vec<(String, Place)> {
    let mut texts: Vec<(String, Place)> = Vec::new();
    match value.get_ref().as_array().filter(|items| !items.is_empty()) {
        None => faults.add(
            &Place::File(value.span().start),
            format!("{name}: {} is not a list of at least one name", raw(value.get_ref())),
        ),
        Some(items) => {
            for item in items.iter() {
                let place = Place::File(item.span().start);
                match raw(item.get_ref()) {
                    Raw::Text(text) if texts.iter().any(|(known, _)| *known == text) => {
                        faults.add(&place, format!("{name}: {text} stands twice"));
                    }
                    Raw::Text(text) => texts.push((text, place)),
                    other => faults.add(&place, format!("{name}: {other} is not text")),
                }
            }
        }
    }
    texts
}

/// The value as written, before it is checked.
pub fn raw(value: &DeValue) -> Raw {
    match value {
        DeValue::String(text) => Raw::Text(text.to_string()),
        DeValue::Integer(n) => match i64::from_str_radix(n.as_str(), n.radix()) {
            Ok(n) => Raw::Integer(n),
            Err(_) => Raw::Text(n.as_str().to_owned()),
        },
        DeValue::Float(x) => match x.as_str().parse() {
            Ok(x) => Raw::Float(x),
            Err(_) => Raw::Text(x.as_str().to_owned()),
        },
        DeValue::Array(items) => Raw::Array(items.iter().map(|item| raw(item.get_ref())).collect()),
        DeValue::Boolean(_) => Raw::Other("boolean"),
        DeValue::Datetime(_) => Raw::Other("date"),
        DeValue::Table(_) => Raw::Other("table"),
    }
}
