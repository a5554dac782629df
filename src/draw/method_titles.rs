//! Titles of methods in place of their code names.

use crate::base::names::Listed;
use crate::instrument::shade::{Method, NONE, REFERENCE};

/// Marks that may follow a name in a text.
const PUNCTUATION: [char; 5] = [':', ',', ';', '.', ')'];

/// The method whose code name is a word of its own, too: without a sample count it stays.
const SAMPLED: &str = "sampled";

/// Replaces the code names of methods in a text by their titles: "Split sum (textbook)" for
/// `split-sum`, "Sampling, 16 samples" for `sampled 16`. The words `none`, `reference` and
/// `sampled` alone stay: they mean other things, too.
pub fn words_in(text: &str) -> String {
    let mut words = text.split(' ').peekable();
    let mut replaced = Vec::new();
    while let Some(word) = words.next() {
        let name = word.trim_end_matches(PUNCTUATION);
        let next = words.peek().map(|next| next.trim_end_matches(PUNCTUATION));
        let count = next.filter(|next| name == word && next.parse::<u32>().is_ok());
        let is_plain_word = [NONE, REFERENCE].contains(&name)
            || (name == SAMPLED && count.is_none() && next != Some("over"));
        let Some(method) = Method::by_name(name).filter(|_| !is_plain_word) else {
            replaced.push(word.to_owned());
            continue;
        };
        let count = count.filter(|_| method.uses_samples);
        let last = if count.is_some() {
            words.next().unwrap_or_default()
        } else {
            word
        };
        let punctuation = &last[last.trim_end_matches(PUNCTUATION).len()..];
        replaced.push(method.words(count) + punctuation);
    }
    replaced.join(" ")
}
