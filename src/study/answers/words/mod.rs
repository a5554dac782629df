//! The answer in words: one headline sentence with its numbers, and what qualifies it.

mod claim;
mod effects;
mod furnace;
mod pairs;
mod range;
mod sizes;
mod slips;
mod times;
mod tone;
mod variants;

use super::Answers;
use super::effects::Effect;
use super::study::Study;
use crate::table::markdown::significant;
use serde::{Deserialize, Serialize};

/// Digits of an error in a sentence.
const ERROR_DIGITS: usize = 2;
/// Digits of a time or a ratio in a sentence.
const TIME_DIGITS: usize = 3;
/// Sentences of one kind beside the headline.
const FACTS_OF_A_KIND: usize = 4;

/// The answer, largest part first.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Answer {
    /// The number that answers, short enough for large type; empty when no one number does.
    pub number: String,
    /// What the number counts.
    pub unit: String,
    /// The answer as a sentence with its numbers and interval.
    pub sentence: String,
    /// Further facts, one sentence each.
    pub facts: Vec<String>,
}

/// Writes the answer for joined runs. What is swept tells what is asked. First what few experiments have: the printed slips ask what each costs, a white furnace asks for energy, sizes
/// of tables ask which are enough, the counts of the claim whether they suffice, more tone curves than sample counts what the curve shows,
/// light whose peaks are cut off what they do. Else break-even leads where there is one, else times; then what a parameter changes, then
/// which way is best. What does not lead follows as facts.
pub fn answer(study: &Study, answers: &Answers) -> Answer {
    let break_even =
        || answers.pairs.iter().find_map(|pair| Some(pairs::from_pair(study, answers, pair, pair.quartiles()?)));
    let values = |axis: usize| study.axes[axis].values.iter().filter(|value| !value.is_empty()).count();
    let is_swept = |name: &str| study.axis(name).is_some_and(|axis| values(axis) > 1);
    let curves: usize = study.display_axes().into_iter().map(values).product();
    let asks_the_curve = curves > study.axis("samples").map_or(1, values);
    // Estimators are asked about before the tables of one of them.
    let asks_the_sizes = !effects::ESTIMATORS.iter().any(|name| is_swept(name));
    let mut leads: Vec<Answer> = Vec::new();
    leads.extend(slips::from_slips(study, answers));
    leads.extend(furnace::from_furnace(answers));
    leads.extend(sizes::from_sizes(answers).filter(|_| asks_the_sizes));
    leads.extend(claim::from_claim(answers));
    leads.extend(tone::from_visibility(answers).filter(|_| asks_the_curve));
    leads.extend(range::from_range(answers).filter(|_| is_swept("environment_clip_log2")));
    leads.extend(break_even().or_else(|| times::from_times(study, answers)));
    leads.extend(tone::from_visibility(answers).filter(|_| !asks_the_curve));
    leads.extend(effects::from_effects(study, answers, asks_the_sizes));
    if leads.is_empty() {
        leads.push(variants::from_variants(study));
    }
    let mut leads = leads.into_iter();
    let mut first = leads.next().expect("one was just added");
    for other in leads {
        first.facts.push(other.sentence);
        first.facts.extend(other.facts);
    }
    first.facts.extend(copies(study));
    first
}

/// How many cells count once, where some do.
fn copies(study: &Study) -> Option<String> {
    let (rows, copies) = (study.rows.len(), study.copy_count());
    (copies > 0).then(|| {
        format!(
            "{copies} of the {} cells differ from another one only in what cannot reach their pixels; each image counts once, so \
             these numbers are of {rows} cells.",
            rows + copies
        )
    })
}

fn plural(count: usize, word: &str) -> String {
    if count == 1 { word.to_owned() } else { format!("{word}s") }
}

/// `a`, `a and b`, `a, b and c`.
fn listed(words: &[String]) -> String {
    match words {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// `+2.1 %` of a ratio of 1.021.
fn change(ratio: f64) -> String {
    let percent = 100.0 * (ratio - 1.0);
    format!("{}{} %", if percent < 0.0 { "−" } else { "+" }, significant(percent.abs(), ERROR_DIGITS))
}

/// ` and 1 more within the reference's noise`, where pairs were left out.
fn noise_words(effect: &Effect) -> String {
    match effect.in_noise {
        0 => String::new(),
        n => format!(" and {n} more within the reference's noise"),
    }
}

/// ` (95 % 0.9 to 1.1)` of a ratio; nothing without an interval.
fn in_brackets(interval: [f64; 2]) -> String {
    match interval[1].is_finite() {
        true => format!(" (95 % {})", interval.map(|end| significant(end, ERROR_DIGITS)).join(" to ")),
        false => String::new(),
    }
}

/// The text with its first letter large.
fn sentence_case(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
