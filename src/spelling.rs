//! Names and numbers in messages: what a misspelt one was meant to be, how a hostile one is shown, how a long one is cut.

use std::borrow::Cow;

/// `; did you mean "x"?` for the nearest of `names`, or nothing when none is near.
///
/// Near: at most half of the longer word differs (Damerau-Levenshtein), so that noise suggests nothing.
pub fn suggestion(wrong: &str, names: &[&str]) -> String {
    names
        .iter()
        .map(|name| (strsim::normalized_damerau_levenshtein(&wrong.to_lowercase(), name), name))
        .filter(|(similarity, _)| *similarity >= 0.5)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| format!("; did you mean {name:?}?"))
        .unwrap_or_default()
}

/// `text` with its control characters written as escapes: names come from files of anyone's making, and a terminal obeys what it shows.
pub fn printable(text: &str) -> String {
    text.chars().fold(String::with_capacity(text.len()), |mut shown, c| {
        if c.is_control() {
            shown.extend(c.escape_default())
        } else {
            shown.push(c)
        }
        shown
    })
}

/// Digits that tell values of an axis apart for a person.
const DIGITS: usize = 4;

/// A number as people read it: `0.223606797749979` is 0.2236. Other text, and numbers that are as short already, stay as they are.
pub fn short_number(text: &str) -> Cow<'_, str> {
    let Some(number) = text.parse::<f64>().ok().filter(|number| number.is_finite()) else { return text.into() };
    if text.parse::<i64>().is_ok() {
        return text.into();
    }
    // Through the exponent form, which counts digits from the first that is not 0.
    let rounded: f64 = format!("{number:.*e}", DIGITS - 1).parse().unwrap_or(number);
    let short = rounded.to_string();
    if short.len() < text.len() { short.into() } else { text.into() }
}
