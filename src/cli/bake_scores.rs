//! Output of `splitsum check-bake`: text, JSON and rows of a page.

use clap::Args;
use glam::DVec3;
use serde_json::{Value, json};
use splitsum::bakes::check::level::LevelScore;
use splitsum::bakes::check::{GOOD, Judged, guess, image};
use splitsum::table::markdown::{Align, MarkdownTable};

pub fn as_text(judged: &Judged, is_guessed: bool) -> String {
    let mut text = String::new();
    for (what, fits) in &judged.axes {
        match judged.doubt(what, fits) {
            Some(doubt) => super::warn(what, &doubt),
            None if is_guessed => text += &format!("{what}: {}\n", guess::in_words(fits)),
            None => {}
        }
    }
    if let Some(way) = &judged.table_way {
        text += &format!("DFG table: {way}\n");
    }
    if !judged.levels.is_empty() || judged.irradiance.is_some() {
        let mut table = MarkdownTable::new(&[
            ("level", Align::Left),
            ("size", Align::Right),
            ("alpha", Align::Right),
            ("rms %", Align::Right),
            ("between texels", Align::Right),
            ("bias %", Align::Right),
        ]);
        for row in rows(judged) {
            let size = format!("{}x{}", row.size[0], row.size[1]);
            table.row(&[row.name, size, row.alpha, row.rms, row.between, row.bias]);
        }
        text += &format!("{table}");
    }
    let maps = rows(judged).into_iter().zip(judged.levels.iter().chain(&judged.irradiance));
    let worst = maps.max_by(|(_, a), (_, b)| a.errors.relmse.total_cmp(&b.errors.relmse));
    if let Some((row, _)) = worst.filter(|(_, score)| score.errors.relmse > GOOD) {
        text += &format!("Worst direction, level {}: {}\n", row.name, row.worst);
    }
    if let Some(off) = judged.spot_check {
        text += &format!(
            "The integrals agree with adaptive cubature within {off:.0e} at three directions of the worst level.\n"
        );
    }
    if let Some(dfg) = &judged.dfg {
        text += &format!(
            "DFG table: max error {:.2e}, rms {:.1e}, worst at n·v {:.3}, roughness {:.3}\n",
            dfg.max_error, dfg.rms, dfg.worst.x, dfg.worst.y
        );
    }
    if let Some(sh) = &judged.sh {
        text += &format!(
            "SH: {:.2} % rms in irradiance, bias {:+.2} %\n",
            100.0 * sh.errors.relmse.sqrt(),
            100.0 * sh.errors.bias_rel
        );
    }
    if let Some(words) = image::in_words(&judged.image) {
        let rungs = ["split sum", "+ levels", "+ map", "+ table", "tables alone"].map(|name| (name, Align::Right));
        let mut table = MarkdownTable::new(&[&[("alpha", Align::Right), ("f0", Align::Right)], &rungs[..]].concat());
        for score in &judged.image {
            let own = [Some(score.split_sum), score.levels, score.map, score.table, Some(score.alone)];
            let cells = own.map(|relmse| relmse.map_or_else(String::new, |relmse| format!("{relmse:.2e}")));
            table.row(&[&[score.alpha.to_string(), score.f0.to_string()], &cells[..]].concat());
        }
        text += &format!("relmse of an image, with one more given table per column:\n{table}{words}.\n");
    }
    for (name, verdict) in judged.parts() {
        text += &format!("{name}: {verdict}\n");
    }
    text + &format!("Verdict: {}\n", judged.verdict())
}

/// The score of a map in words.
struct Row {
    name: String,
    size: [u32; 2],
    alpha: String,
    /// Error in percent, as are errors between texels and the bias.
    rms: String,
    between: String,
    bias: String,
    worst: String,
}

/// Formats the scores of maps.
fn rows(judged: &Judged) -> Vec<Row> {
    let numbered = judged.levels.iter().enumerate().map(|(k, score)| (k.to_string(), score));
    let all = numbered.chain(judged.irradiance.iter().map(|score| ("irradiance".to_owned(), score)));
    let mean = |rgb: DVec3| rgb.element_sum() / 3.0;
    let rms = |relmse: f64| format!("{:.2}", 100.0 * relmse.sqrt());
    let row = |(name, score): (String, &LevelScore)| {
        let worst = &score.worst;
        let ([x, y, z], [face, column, row]) = (worst.direction.to_array(), worst.texel);
        let values = format!("{:.3} for {:.3}", mean(worst.found), mean(worst.exact));
        Row {
            name,
            size: score.size,
            alpha: format!("{:.4}", score.alpha),
            rms: rms(score.errors.relmse),
            between: score.between.map_or_else(String::new, rms),
            bias: format!("{:+.2}", 100.0 * score.errors.bias_rel),
            worst: format!("({x:.2}, {y:.2}, {z:.2}), face {face} texel {column},{row}: {values}"),
        }
    };
    all.map(row).collect()
}

/// Largest scores that pass; none by default.
#[derive(Args, Clone, Copy, Debug)]
pub struct Limits {
    /// Exit 1 if the relmse of a level, of irradiance or of SH is above X.
    #[arg(long, value_name = "X", value_parser = threshold)]
    pub fail_above: Option<f64>,
    /// Exit 1 if the relmse between the texels of a level is above X.
    #[arg(long, value_name = "X", value_parser = threshold)]
    pub fail_between_above: Option<f64>,
    /// Exit 1 if the largest error of the DFG table is above X.
    #[arg(long, value_name = "X", value_parser = threshold)]
    pub fail_table_above: Option<f64>,
    /// Exit 1 if the axes or the environment seem wrong.
    #[arg(long)]
    pub fail_on_warning: bool,
    /// Exit 1 if the verdict is `wrong`.
    #[arg(long)]
    pub fail_on_wrong: bool,
}

fn threshold(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|x| x.is_finite() && *x >= 0.0);
    number.ok_or_else(|| "expected a number of at least 0; an error of 1 % rms is a relmse of 1e-4".to_owned())
}

impl Limits {
    /// Lists the scores above a limit, one a line.
    pub fn failures(&self, judged: &Judged) -> Vec<String> {
        let levels = || judged.levels.iter().enumerate().map(|(k, score)| (format!("level {k}"), score));
        let relmse = levels().map(|(name, score)| (name, "relmse", score.errors.relmse));
        let irradiance = judged.irradiance.iter().map(|score| ("irradiance".to_owned(), "relmse", score.errors.relmse));
        let sh = judged.sh.iter().map(|score| ("SH".to_owned(), "relmse", score.errors.relmse));
        let maps = relmse.chain(irradiance).chain(sh).map(|own| (own, self.fail_above));
        let between = levels().filter_map(|(name, score)| Some((name, "relmse between texels", score.between?)));
        let between = between.map(|own| (own, self.fail_between_above));
        let table = judged.dfg.iter().map(|score| ("DFG table".to_owned(), "max error", score.max_error));
        let table = table.map(|own| (own, self.fail_table_above));
        // NaN does not pass.
        let is_above = |value: f64, limit: f64| value.is_nan() || value > limit;
        let scores = maps.chain(between).chain(table).filter_map(|((name, what, value), limit)| {
            let limit = limit.filter(|limit| is_above(value, *limit))?;
            Some(format!("{name}: {what} {value:.2e} is above {limit:.2e}"))
        });
        let doubts =
            judged.axes.iter().filter_map(|(what, fits)| Some(format!("{what}: {}", judged.doubt(what, fits)?)));
        let wrong = judged.wrong().filter(|_| self.fail_on_wrong);
        scores.chain(doubts.filter(|_| self.fail_on_warning)).chain(wrong).collect()
    }
}

pub fn as_json(environment: &str, preset: &str, limits: &Limits, judged: &Judged) -> Value {
    let failures = limits.failures(judged);
    let level = |score: &LevelScore| {
        let worst = &score.worst;
        json!({
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
            "slip": score.slip.as_ref().map(|slip| json!({ "words": slip.words, "left": slip.left })),
            "fit": score.fit.map(|fit| json!({ "alpha": fit.alpha, "gain": fit.gain, "left": fit.left })),
            "verdict": score.verdict,
        })
    };
    let axes = judged.axes.iter().map(|(what, fits)| {
        let best: Vec<Value> = fits
            .iter()
            .take(4)
            .map(|fit| json!({ "axes": fit.axes.to_string(), "correlation": fit.correlation }))
            .collect();
        json!({ "of": what, "best": best, "warning": judged.doubt(what, fits) })
    });
    json!({
        "environment": environment,
        "preset": preset,
        "verdict": judged.verdict(),
        "chain": judged.chain,
        "limits": {
            "fail_above": limits.fail_above,
            "fail_between_above": limits.fail_between_above,
            "fail_table_above": limits.fail_table_above,
            "fail_on_warning": limits.fail_on_warning,
            "fail_on_wrong": limits.fail_on_wrong,
        },
        "failures": failures,
        "passes": failures.is_empty(),
        "axes": judged.convention.axes.to_string(),
        "axes_fits": axes.collect::<Vec<_>>(),
        "levels": judged.levels.iter().map(level).collect::<Vec<_>>(),
        "image": judged.image,
        "image_verdict": image::in_words(&judged.image),
        "spot_check": judged.spot_check,
        "irradiance": judged.irradiance.as_ref().map(level),
        "dfg": judged.dfg.as_ref().map(|dfg| json!({
            "max_error": dfg.max_error,
            "rms": dfg.rms,
            "worst": { "n_dot_v": dfg.worst.x, "perceptual_roughness": dfg.worst.y },
            "texels": dfg.count,
            "verdict": dfg.verdict,
        })),
        "sh": judged.sh.as_ref().map(|sh| json!({
            "relmse": sh.errors.relmse,
            "bias_rel": sh.errors.bias_rel,
            "max_error": sh.max_error,
            "verdict": sh.verdict,
        })),
    })
}
