//! Names in messages: what a misspelt one was meant to be, and how a hostile one is shown.

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
