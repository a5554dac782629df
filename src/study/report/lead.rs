//! Which chart stands beside the answer. It follows the order of `answers::words`: what an experiment sweeps says what it asks.

use crate::study::answers::Answers;
use crate::study::answers::sizes::leading;
use crate::study::answers::study::{Role, Study};
use serde::Serialize;

/// The first chart of a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Lead {
    /// Exposure and contrast, for each method.
    Visibility,
    /// What leaves over what arrives in a white furnace, over `n_dot_v`.
    Energy,
    /// Error over the dynamic range of the light.
    Range,
    /// Error of a sampling method over that of one without samples.
    BreakEven,
    /// Pass times, and what is made once.
    Times,
    /// Error over the values of a parameter or estimator, as ratios to its first value.
    Effects { axis: String },
    /// Error over the sample count.
    Convergence,
    /// Error over a property of the scene.
    Sweep { axis: String },
    /// Error over `n_dot_v`.
    Profile,
}

/// Axes that choose an estimator; all others with effects are parameters of one.
const ESTIMATORS: [&str; 2] = ["method", "diffuse"];
/// A parameter with fewer values is a comparison of two, not a sweep.
const SWEEP_MIN: usize = 3;

/// The chart of a run that stands alone.
pub fn lead(study: &Study, answers: &Answers) -> Lead {
    if !answers.furnace.is_empty() {
        return Lead::Energy;
    }
    let values = |axis: usize| study.axes[axis].values.iter().filter(|value| !value.is_empty()).count();
    let named = |name: &str| study.axis(name).map_or(0, values);
    let asks_the_sizes = !ESTIMATORS.iter().any(|name| named(name) > 1);
    if let Some(one) = leading(&answers.enough).filter(|_| asks_the_sizes) {
        return Lead::Effects { axis: one.axis.clone() };
    }
    let settings: usize = study.display_axes().into_iter().map(values).product();
    if settings > named("samples").max(1) && answers.visibility.iter().any(|one| one.method != "none") {
        return Lead::Visibility;
    }
    if named("environment_clip_log2") > 1 && !answers.dynamic_range.is_empty() {
        return Lead::Range;
    }
    if !answers.pairs.is_empty() {
        return Lead::BreakEven;
    }
    if !answers.frame_ratios.is_empty() {
        return Lead::Times;
    }
    let is_estimator = |axis: &&str| ESTIMATORS.contains(axis);
    let with_effects: Vec<&str> = answers.effects.iter().map(|effect| effect.axis.as_str()).collect();
    let effects = |axis: &str| Lead::Effects { axis: axis.to_owned() };
    // Of equals the first in the order of the axes.
    let swept = with_effects.iter().filter(|axis| !is_estimator(axis) && named(axis) >= SWEEP_MIN);
    if let Some(axis) = swept.rev().max_by_key(|axis| named(axis)) {
        return effects(axis);
    }
    if answers.curves.iter().any(|curve| curve.points.len() > 1) {
        return Lead::Convergence;
    }
    if let Some(axis) = with_effects.iter().find(|axis| is_estimator(axis)).or(with_effects.first()) {
        return effects(axis);
    }
    sweep(study)
}

/// The error over the swept property of the scene that is a number: alpha, or else the one with most values.
fn sweep(study: &Study) -> Lead {
    let values = |axis: usize| study.axes[axis].values.len();
    let is_number = |axis: usize| study.axes[axis].values.iter().all(|value| value.parse::<f64>().is_ok());
    let of_scene = (0..study.axes.len())
        .filter(|&axis| study.axes[axis].role == Role::Scene && values(axis) >= SWEEP_MIN && is_number(axis));
    match of_scene.max_by_key(|&axis| (study.axes[axis].name == "alpha", values(axis))) {
        Some(axis) => Lead::Sweep { axis: study.axes[axis].name.clone() },
        None => Lead::Profile,
    }
}
