//! Limits of scores, and scores as JSON.

use super::bake::Judged;
use super::level::LevelScore;
use super::{Cause, words};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

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

impl Limits {
    /// Lists the scores above a limit, one a line.
    pub fn failures(&self, judged: &Judged) -> Vec<String> {
        let levels = || {
            judged
                .levels
                .iter()
                .enumerate()
                .map(|(k, score)| (format!("level {k}"), score))
        };
        let relmse = levels().map(|(name, score)| (name, "relmse", score.errors.relmse));
        let irradiance = judged
            .irradiance
            .iter()
            .map(|score| ("irradiance".to_owned(), "relmse", score.errors.relmse));
        let sh = judged
            .sh
            .iter()
            .map(|score| ("SH".to_owned(), "relmse", score.errors.relmse));
        let maps = relmse
            .chain(irradiance)
            .chain(sh)
            .map(|own| (own, self.fail_above));
        let between = levels()
            .filter_map(|(name, score)| Some((name, "relmse between texels", score.between?)));
        let between = between.map(|own| (own, self.fail_between_above));
        let table = judged
            .dfg
            .iter()
            .map(|score| ("DFG table".to_owned(), "max error", score.max_error));
        let table = table.map(|own| (own, self.fail_table_above));
        // NaN does not pass.
        let is_above = |value: f64, limit: f64| value.is_nan() || value > limit;
        let scores = maps
            .chain(between)
            .chain(table)
            .filter_map(|((name, what, value), limit)| {
                let limit = limit.filter(|limit| is_above(value, *limit))?;
                Some(format!("{name}: {what} {value:.2e} is above {limit:.2e}"))
            });
        let doubts = judged.axes.iter().filter_map(|(what, fits)| {
            Some(format!("{what}: {}", judged.doubt(what, fits)?.words))
        });
        let wrong = judged.wrong().filter(|_| self.fail_on_wrong);
        scores
            .chain(doubts.filter(|_| self.fail_on_warning))
            .chain(wrong)
            .collect()
    }
}

pub fn as_json(environment: &str, preset: &str, limits: &Limits, judged: &Judged) -> Value {
    let failures = limits.failures(judged);
    let causes = |causes: &[Cause]| -> Vec<Value> {
        causes
            .iter()
            .map(|cause| json!({ "kind": cause.kind, "words": cause.words }))
            .collect()
    };
    let level = |(name, score): (String, &LevelScore)| {
        let worst = &score.worst;
        json!({
            "passes": !failures.iter().any(|failure| failure.starts_with(&format!("{name}: "))),
            "size": score.size,
            "alpha": score.alpha,
            "relmse": score.errors.relmse,
            "relmse_between": score.between,
            "bias_rel": score.errors.bias_rel,
            "worst": {
                "direction": worst.direction.to_array(),
                "face": worst.texel[0],
                "column": worst.texel[1],
                "row": worst.texel[2],
                "found": worst.found.to_array(),
                "exact": worst.exact.to_array(),
            },
            "slip": score.slip.as_ref().map(|slip| json!({ "words": words(&slip.causes), "left": slip.left })),
            "causes": causes(&score.causes),
            "relmse_left": score.left(),
            "fit": score.fit.map(|fit| json!({ "alpha": fit.alpha, "gain": fit.gain, "left": fit.left })),
            "verdict": score.verdict,
        })
    };
    let levels = judged
        .levels
        .iter()
        .enumerate()
        .map(|(k, score)| (format!("level {k}"), score));
    let axes = judged.axes.iter().map(|(what, fits)| {
        let best =
            fits.iter().take(4).map(|fit| json!({ "axes": fit.axes.to_string(), "correlation": fit.correlation }));
        json!({ "of": what, "best": best.collect::<Vec<_>>(), "warning": judged.doubt(what, fits).map(|doubt| doubt.words + &doubt.more) })
    });
    json!({
        "environment": environment,
        "preset": preset,
        "verdict": judged.verdict(),
        "chain": judged.chain.as_ref().map(|chain| &chain.words),
        "causes": causes(&judged.causes()),
        "limits": limits,
        "failures": failures,
        "passes": failures.is_empty(),
        "axes": judged.convention.axes.to_string(),
        "axes_fits": axes.collect::<Vec<_>>(),
        "levels": levels.map(level).collect::<Vec<_>>(),
        "irradiance": judged.irradiance.as_ref().map(|score| level(("irradiance".to_owned(), score))),
        "dfg": judged.dfg.as_ref().map(|dfg| json!({
            "max_error": dfg.max_error,
            "rms": dfg.rms,
            "worst": { "n_dot_v": dfg.worst.x, "perceptual_roughness": dfg.worst.y },
            "texels": dfg.count,
            "causes": causes(&dfg.causes),
            "verdict": dfg.verdict,
        })),
        "sh": judged.sh.as_ref().map(|sh| json!({
            "relmse": sh.errors.relmse,
            "bias_rel": sh.errors.bias_rel,
            "max_error": sh.max_error,
            "causes": causes(&sh.causes),
            "verdict": sh.verdict,
        })),
    })
}
