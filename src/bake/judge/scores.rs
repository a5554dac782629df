//! Limits of scores, and scores as JSON.

use super::bake::Judged;
use super::cause::Cause;
use super::doubt::RankedAxes;
use super::level::LevelScore;
use super::sh::ShScore;
use super::table::TableScore;
use super::verdict::Part;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::fmt;

/// Axes of a map that JSON lists.
const AXES_LISTED: usize = 4;

/// Largest scores that pass; none by default.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
#[serde(default, deny_unknown_fields)]
pub struct Limits {
    /// Fail if the relmse of a level, of irradiance or of SH is above X.
    #[cfg_attr(feature = "cli", arg(long, value_name = "X", value_parser = threshold))]
    pub fail_above: Option<f64>,
    /// Fail if the relmse between the texels of a level is above X.
    #[cfg_attr(feature = "cli", arg(long, value_name = "X", value_parser = threshold))]
    pub fail_between_above: Option<f64>,
    /// Fail if the largest error of the DFG table is above X.
    #[cfg_attr(feature = "cli", arg(long, value_name = "X", value_parser = threshold))]
    pub fail_table_above: Option<f64>,
    /// Fail if the axes or the environment seem wrong.
    #[cfg_attr(feature = "cli", arg(long))]
    pub fail_on_warning: bool,
    /// Fail if the verdict is `wrong`.
    #[cfg_attr(feature = "cli", arg(long))]
    pub fail_on_wrong: bool,
}

#[cfg(feature = "cli")]
fn threshold(text: &str) -> Result<f64, String> {
    let number = text
        .parse::<f64>()
        .ok()
        .filter(|x| x.is_finite() && *x >= 0.0);
    number.ok_or_else(|| {
        "expected a number of at least 0; an error of 1 % rms is a relmse of 1e-4".to_owned()
    })
}

/// A kind of score that has a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ScoreKind {
    Relmse,
    RelmseBetween,
    MaxError,
}

/// A score of a part.
#[derive(Clone, Copy, Debug)]
struct Score {
    part: Part,
    kind: ScoreKind,
    value: f64,
}

/// A score above its limit.
#[derive(Clone, Copy, Debug)]
struct Excess {
    score: Score,
    limit: f64,
}

impl fmt::Display for Excess {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self {
            score: Score { part, kind, value },
            limit,
        } = self;
        let kind = match kind {
            ScoreKind::Relmse => "relmse",
            ScoreKind::RelmseBetween => "relmse between texels",
            ScoreKind::MaxError => "max error",
        };
        write!(f, "{part}: {kind} {value:.2e} is above {limit:.2e}")
    }
}

impl Limits {
    /// Lists the scores above a limit, one a line.
    pub fn failures(&self, judged: &Judged) -> Vec<String> {
        let mut failures: Vec<String> = self
            .excesses(judged)
            .iter()
            .map(Excess::to_string)
            .collect();
        if self.fail_on_warning {
            failures.extend(judged.warnings().iter().map(ToString::to_string));
        }
        if self.fail_on_wrong {
            failures.extend(judged.wrong());
        }
        failures
    }

    fn excesses(&self, judged: &Judged) -> Vec<Excess> {
        scores(judged)
            .into_iter()
            .filter_map(|score| {
                let limit = self.limit(score.kind)?;
                // NaN does not pass.
                let is_above = score.value.is_nan() || score.value > limit;
                is_above.then_some(Excess { score, limit })
            })
            .collect()
    }

    fn limit(&self, kind: ScoreKind) -> Option<f64> {
        match kind {
            ScoreKind::Relmse => self.fail_above,
            ScoreKind::RelmseBetween => self.fail_between_above,
            ScoreKind::MaxError => self.fail_table_above,
        }
    }
}

/// Lists the scores of a bake: relMSE of every part, then between texels, then of the table.
fn scores(judged: &Judged) -> Vec<Score> {
    let mut scores = Vec::new();
    let mut add = |part: Part, kind: ScoreKind, value: f64| {
        scores.push(Score { part, kind, value });
    };
    for (level, score) in judged.levels.iter().enumerate() {
        add(Part::Level(level), ScoreKind::Relmse, score.errors.relmse);
    }
    if let Some(score) = &judged.irradiance {
        add(Part::Irradiance, ScoreKind::Relmse, score.errors.relmse);
    }
    if let Some(score) = &judged.sh {
        add(Part::Sh, ScoreKind::Relmse, score.errors.relmse);
    }
    for (level, score) in judged.levels.iter().enumerate() {
        if let Some(between) = score.between {
            add(Part::Level(level), ScoreKind::RelmseBetween, between);
        }
    }
    if let Some(score) = &judged.dfg {
        add(Part::Table, ScoreKind::MaxError, score.max_error);
    }
    scores
}

/// Writes scores, verdicts and failures as JSON.
pub fn as_json(environment: &str, preset: &str, limits: &Limits, judged: &Judged) -> Value {
    let excesses = limits.excesses(judged);
    let passes = |part: Part| !excesses.iter().any(|excess| excess.score.part == part);
    let failures = limits.failures(judged);
    let levels: Vec<Value> = judged
        .levels
        .iter()
        .enumerate()
        .map(|(level, score)| level_json(score, passes(Part::Level(level))))
        .collect();
    let irradiance = judged
        .irradiance
        .as_ref()
        .map(|score| level_json(score, passes(Part::Irradiance)));
    let axes: Vec<Value> = judged
        .axes
        .iter()
        .map(|ranked| axes_json(judged, ranked))
        .collect();
    json!({
        "environment": environment,
        "preset": preset,
        "verdict": judged.verdict(),
        "chain": judged.chain.as_ref().map(|chain| chain.slip.to_string()),
        "causes": causes_json(&judged.causes()),
        "limits": limits,
        "failures": failures,
        "passes": failures.is_empty(),
        "axes": judged.convention.axes.to_string(),
        "axes_fits": axes,
        "levels": levels,
        "irradiance": irradiance,
        "dfg": judged.dfg.as_ref().map(table_json),
        "sh": judged.sh.as_ref().map(sh_json),
    })
}

fn level_json(score: &LevelScore, passes: bool) -> Value {
    let worst = &score.worst;
    let [face, column, row] = worst.texel;
    let slip = score
        .slip
        .as_ref()
        .map(|slip| json!({ "words": score.slip_in_words(), "left": slip.left }));
    let fit = score
        .fit
        .map(|fit| json!({ "alpha": fit.alpha, "gain": fit.gain, "left": fit.left }));
    json!({
        "passes": passes,
        "size": score.size,
        "alpha": score.alpha,
        "relmse": score.errors.relmse,
        "relmse_between": score.between,
        "bias_rel": score.errors.bias_rel,
        "worst": {
            "direction": worst.direction.to_array(),
            "face": face,
            "column": column,
            "row": row,
            "found": worst.found.to_array(),
            "exact": worst.exact.to_array(),
        },
        "negative_texels": score.negative.map_or(0, |texels| texels.count),
        "slip": slip,
        "causes": causes_json(score.verdict.causes()),
        "relmse_left": score.left(),
        "fit": fit,
        "verdict": score.verdict.to_string(),
    })
}

fn axes_json(judged: &Judged, ranked: &RankedAxes) -> Value {
    let best: Vec<Value> = ranked
        .ranking
        .iter()
        .take(AXES_LISTED)
        .map(|fit| json!({ "axes": fit.axes.to_string(), "correlation": fit.correlation }))
        .collect();
    let warning = judged.warning(ranked).map(|warning| warning.details());
    json!({ "of": ranked.map.to_string(), "best": best, "warning": warning })
}

fn table_json(score: &TableScore) -> Value {
    json!({
        "max_error": score.max_error,
        "rms": score.rms,
        "worst": { "n_dot_v": score.worst.x, "perceptual_roughness": score.worst.y },
        "texels": score.count,
        "causes": causes_json(score.verdict.causes()),
        "verdict": score.verdict.to_string(),
    })
}

fn sh_json(score: &ShScore) -> Value {
    json!({
        "relmse": score.errors.relmse,
        "bias_rel": score.errors.bias_rel,
        "max_error": score.max_error,
        "causes": causes_json(score.verdict.causes()),
        "verdict": score.verdict.to_string(),
    })
}

fn causes_json(causes: &[Cause]) -> Vec<Value> {
    causes
        .iter()
        .map(|cause| json!({ "kind": cause.kind(), "words": cause.to_string() }))
        .collect()
}
