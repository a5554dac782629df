//! What the tone curve shows and hides.

use super::{Answer, ERROR_DIGITS, FACTS_OF_A_KIND, listed};
use crate::shade::METHODS;
use crate::study::answers::Answers;
use crate::study::answers::exposure::{Hiding, VISIBLE_FROM, Visibility, hiding};
use crate::table::markdown::significant;

/// Where the limit comes from.
pub(super) const SOURCE: &str = "this project's convention, since FLIP's authors give none";

fn text(x: f64) -> String {
    significant(x, ERROR_DIGITS)
}

/// Ascending values with runs of neighbours among the tried ones drawn together: `0.1 to 5`, `0.1 and 500`.
fn runs(tried: &[f64], wanted: &[f64]) -> String {
    let mut parts: Vec<(f64, f64)> = Vec::new();
    let mut is_open = false;
    for value in tried {
        let is_wanted = wanted.contains(value);
        match parts.last_mut().filter(|_| is_open && is_wanted) {
            Some(part) => part.1 = *value,
            None if is_wanted => parts.push((*value, *value)),
            None => {}
        }
        is_open = is_wanted;
    }
    let words: Vec<String> =
        parts.iter().map(|(lo, hi)| if lo == hi { lo.to_string() } else { format!("{lo} to {hi}") }).collect();
    listed(&words)
}

/// Where a method's difference shows: contrasts with the same exposures together, those with most first.
fn shown(own: &[&Hiding]) -> String {
    let mut groups: Vec<(String, usize, Vec<String>)> = Vec::new();
    for one in own {
        let visible: Vec<f64> = one.tried.iter().copied().filter(|x| !one.hidden_at.contains(x)).collect();
        let words = match visible.len() {
            0 => "nowhere".to_owned(),
            n if n == one.tried.len() => "at every tried exposure".to_owned(),
            _ => format!("at exposure {}", runs(&one.tried, &visible)),
        };
        match groups.iter_mut().find(|(known, ..)| *known == words) {
            Some(group) => group.2.push(one.contrast.to_string()),
            None => groups.push((words, visible.len(), vec![one.contrast.to_string()])),
        }
    }
    groups.sort_by_key(|(_, count, _)| std::cmp::Reverse(*count));
    groups.iter().map(|(words, _, at)| format!("{words} (contrast {})", listed(at))).collect::<Vec<_>>().join(", ")
}

pub(super) fn from_visibility(answers: &Answers) -> Option<Answer> {
    // The image without a specular term is there for scale.
    let hiding: Vec<Hiding> = hiding(&answers.visibility).into_iter().filter(|one| one.method != "none").collect();
    // Methods without samples before the others, and those with most samples next, as listed.
    let mut methods: Vec<&str> = Vec::new();
    for one in &hiding {
        if !methods.contains(&one.method.as_str()) {
            methods.push(&one.method);
        }
    }
    let samples = |method: &str| method.rsplit(' ').next().and_then(|n| n.parse::<f64>().ok()).unwrap_or(f64::INFINITY);
    let place = |method: &str| METHODS.iter().position(|known| method.split(' ').next() == Some(known.name));
    methods.sort_by(|a, b| samples(b).total_cmp(&samples(a)).then(place(a).cmp(&place(b))));
    let say = |method: &str| -> Option<(f64, String)> {
        let mut own: Vec<&Hiding> = hiding.iter().filter(|one| one.method == method).collect();
        own.sort_by(|a, b| a.contrast.total_cmp(&b.contrast));
        let peak = peak(answers, method)?;
        let hidden: Vec<f64> = own.iter().flat_map(|one| one.hidden_at.iter().copied()).collect();
        let tried: Vec<f64> = own.iter().flat_map(|one| one.tried.iter().copied()).collect();
        let hidden = if hidden.is_empty() {
            String::new()
        } else {
            let (lo, hi) = tried.iter().fold((f64::INFINITY, 0.0f64), |(lo, hi), x| (lo.min(*x), hi.max(*x)));
            format!(
                ", and the other {} of {} tone curves, exposures from {lo} to {hi}, hide it",
                hidden.len(),
                tried.len()
            )
        };
        let spread = if peak.n > 1 {
            format!(
                ", the middle half of {} cases {} to {}",
                peak.n,
                text(peak.lower_quartile),
                text(peak.upper_quartile)
            )
        } else {
            String::new()
        };
        let sentence = format!(
            "the error of {method} shows most at exposure {} and contrast {} (mean FLIP {}{spread}); it is visible {}{hidden}",
            peak.exposure,
            peak.contrast,
            text(peak.median),
            shown(&own)
        );
        Some((peak.exposure, sentence))
    };
    let lead = methods.first()?;
    let (exposure, sentence) = say(lead)?;
    let rest = methods.iter().skip(1).filter_map(|method| say(method)).take(FACTS_OF_A_KIND);
    Some(Answer {
        number: exposure.to_string(),
        unit: format!("the exposure at which the error of {lead} shows most"),
        sentence: format!(
            "After the tone curve {sentence}; visible is a mean FLIP of at least {VISIBLE_FROM}, {SOURCE}."
        ),
        facts: rest.map(|(_, sentence)| format!("After the tone curve {sentence}.")).collect(),
    })
}

/// The tone curve at which a method's difference shows most.
fn peak<'a>(answers: &'a Answers, method: &str) -> Option<&'a Visibility> {
    let own = answers.visibility.iter().filter(|one| one.method == method);
    own.max_by(|a, b| a.median.total_cmp(&b.median))
}
