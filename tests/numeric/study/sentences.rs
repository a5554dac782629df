//! Checks that sentences agree with tables.

use splitsum::base::csv::Cell;
use splitsum::draw::markdown::significant;
use splitsum::study::questions::Finding;
use splitsum::study::table::Table;
use std::collections::{BTreeMap, HashSet};

/// The sentences of a text: each ends with a full stop before a blank or the end.
pub fn sentences(text: &str) -> Vec<&str> {
    text.trim().split_inclusive(". ").map(str::trim).collect()
}

/// Words of a sentence: parts with a letter or digit.
pub fn word_count(sentence: &str) -> usize {
    sentence
        .split_whitespace()
        .filter(|word| word.contains(char::is_alphanumeric))
        .count()
}

/// The text without its code spans, which are names, not words.
fn without_names(text: &str) -> String {
    text.split('`').step_by(2).collect::<Vec<_>>().join(" ")
}

/// Every number as written: `16`, `-0.95`, `1.3e-6`, `1234` of `1,234`. A minus between letters or
/// digits is a hyphen.
pub fn numbers(text: &str) -> Vec<String> {
    let letters: Vec<char> = text.replace('−', "-").chars().collect();
    let is_digit = |i: usize| letters.get(i).is_some_and(char::is_ascii_digit);
    let mut found = Vec::new();
    let mut i = 0;
    while i < letters.len() {
        if !is_digit(i) {
            i += 1;
            continue;
        }
        let mut number = String::new();
        let is_signed =
            i > 0 && letters[i - 1] == '-' && (i < 2 || !letters[i - 2].is_alphanumeric());
        number.extend(is_signed.then_some('-'));
        loop {
            match letters.get(i) {
                Some(digit) if digit.is_ascii_digit() => number.push(*digit),
                Some('.') if is_digit(i + 1) && !number.contains('.') => number.push('.'),
                // Thousands.
                Some(',') if (i + 1..i + 4).all(is_digit) && !is_digit(i + 4) => {}
                Some('e') if is_digit(i + 1) && !number.contains('e') => number.push('e'),
                Some('e')
                    if letters.get(i + 1) == Some(&'-')
                        && is_digit(i + 2)
                        && !number.contains('e') =>
                {
                    number.push_str("e-");
                    i += 1;
                }
                _ => break,
            }
            i += 1;
        }
        found.push(number);
    }
    found
}

/// How the numbers of a table may be written.
fn known(table: &Table, found: &mut HashSet<String>) {
    let mut add = |text: &str| found.extend(numbers(text));
    table.columns.iter().for_each(|name| add(name));
    add(&table.rows.len().to_string());
    for column in 0..table.columns.len() {
        // How many rows have each value.
        let mut counts: BTreeMap<String, usize> = BTreeMap::new();
        for row in &table.rows {
            match &row[column] {
                Cell::Missing => continue,
                Cell::Text(_) | Cell::Quantity(_) | Cell::Named(_) => {
                    add(row[column].text().unwrap_or_default());
                }
                Cell::Integer(n) => add(&n.to_string()),
                Cell::Number(x) => {
                    add(&x.to_string());
                    (1..=4).for_each(|digits| add(&significant(*x, digits)));
                }
            }
            *counts.entry(format!("{:?}", row[column])).or_default() += 1;
        }
        // A row over all values does not count as a value.
        let over_all = usize::from(counts.contains_key("Text(\"all\")"));
        add(&(counts.len() - over_all).to_string());
        let of_names = counts.iter().filter(|(value, _)| {
            let is_name = |kind: &&str| value.starts_with(kind);
            ["Text", "Named"].iter().any(is_name)
        });
        of_names.for_each(|(_, count)| add(&count.to_string()));
    }
}

/// Numbers in a sentence of a finding that its table and digest lack: they are neither numbers
/// there, nor counts of rows, of rows with one name in a column, or of distinct values of a column.
/// The 95 of "95 %" is the size of every interval.
pub fn unfounded(finding: &Finding) -> Vec<String> {
    let mut known_numbers = HashSet::new();
    [Some(&finding.table), finding.digest.as_ref()]
        .into_iter()
        .flatten()
        .for_each(|table| known(table, &mut known_numbers));
    let text = without_names(&finding.sentences.markdown()).replace("95 %", "");
    numbers(&text)
        .into_iter()
        .filter(|number| !known_numbers.contains(number))
        .collect()
}
