//! What the slips of the source documents cost.

use super::{Answer, ERROR_DIGITS, FACTS_OF_A_KIND, TIME_DIGITS, in_brackets, plural};
use crate::slips::{Cost, VISIBLE_RATIO};
use crate::study::answers::Answers;
use crate::study::answers::effects::{Effect, against};
use crate::study::answers::study::{Study, short};
use crate::table::markdown::significant;

/// The axis that parts the scenes in which a printed estimator is tried.
const SCENES: &str = "environment";

fn text(x: f64) -> String {
    significant(x, TIME_DIGITS)
}

fn named(cost: &Cost) -> String {
    let [printed, right] = [cost.figure.printed, cost.figure.right].map(text);
    format!(
        "document {}, {}: {printed} instead of {right} ({})",
        cost.slip.document, cost.slip.printed, cost.figure.quantity
    )
}

/// Which slip costs most, how many are seen, and what the printed estimator does to images of each environment.
pub(super) fn from_slips(study: &Study, answers: &Answers) -> Option<Answer> {
    let mut of_light: Vec<(&Cost, f64)> =
        answers.slips.iter().filter_map(|cost| Some((cost, cost.light_ratio?))).collect();
    of_light.sort_by(|a, b| b.1.total_cmp(&a.1));
    let (most, ratio) = *of_light.first()?;
    let visible = of_light.iter().filter(|(_, ratio)| *ratio > VISIBLE_RATIO).count();
    let (total, others) = (answers.slips.len(), answers.slips.len() - of_light.len());
    let percent = significant(100.0 * (VISIBLE_RATIO - 1.0), ERROR_DIGITS);
    let rest = of_light.iter().skip(1).take(FACTS_OF_A_KIND);
    let mut facts: Vec<String> =
        rest.map(|(cost, ratio)| format!("A factor of {}: {}.", text(*ratio), named(cost))).collect();
    let hidden: Vec<String> =
        of_light.iter().filter(|(_, ratio)| *ratio <= VISIBLE_RATIO).map(|(cost, _)| named(cost)).collect();
    if !hidden.is_empty() {
        facts.push(format!("Not seen, by at most {percent} % of the light: {}.", hidden.join("; ")));
    }
    if others > 0 {
        facts.push(format!(
            "The figures of the other {others} {} are no ratios of light: levels, angles, exponents, steps, what is undefined.",
            plural(others, "slip")
        ));
    }
    facts.extend(in_images(study));
    Some(Answer {
        number: format!("{visible} of {total}"),
        unit: format!("printed slips change the light by more than {percent} %"),
        sentence: format!(
            "The slip that costs most makes light wrong by a factor of {}: {}; {visible} of the {total} slips change light by more than \
             {percent} %, which is seen side by side.",
            text(ratio),
            named(most)
        ),
        facts,
    })
}

/// What each method does to the error beside the first one, environment by environment: how wrong a formula is hangs on what it lights.
fn in_images(study: &Study) -> Vec<String> {
    let Some(method) = study.axis("method") else { return Vec::new() };
    let Some(base) = study.axes[method].values.first() else { return Vec::new() };
    let scenes = study.axis(SCENES).map_or(&[][..], |axis| study.axes[axis].values.as_slice());
    let of_scene = |scene: &String| -> Vec<(String, Effect)> {
        let own = against(study, method, base, &|row| study.value(row, SCENES) == scene.as_str());
        own.into_iter().filter(|effect| effect.alpha.is_none()).map(|effect| (scene.clone(), effect)).collect()
    };
    let all: Vec<(String, Effect)> = scenes.iter().flat_map(of_scene).collect();
    let mut kinds: Vec<[&str; 2]> = Vec::new();
    for (_, effect) in &all {
        let kind = [effect.value.as_str(), effect.method.as_str()];
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
    }
    let sentence = |[value, samples]: [&str; 2]| {
        let own = all.iter().filter(|(_, effect)| [effect.value.as_str(), effect.method.as_str()] == [value, samples]);
        let words = own.map(|(scene, effect)| {
            format!("{} in {}{}", text(effect.ratio), short(SCENES, scene), in_brackets(effect.interval))
        });
        let at = if samples.is_empty() { String::new() } else { format!(" at {samples} samples") };
        format!(
            "In images {value} instead of {base} multiplies the error{at} by {}.",
            super::listed(&words.collect::<Vec<_>>())
        )
    };
    kinds.into_iter().map(sentence).collect()
}
