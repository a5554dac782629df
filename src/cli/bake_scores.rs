//! Output of `splitsum check-bake`: text, JSON and rows of a page.

use glam::DVec3;
use serde_json::{Value, json};
use splitsum::bakes::check::level::LevelScore;
use splitsum::bakes::check::{Judged, guess, image};
use splitsum::bakes::page::Row;
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
            ("relmse", Align::Right),
            ("between texels", Align::Right),
            ("bias %", Align::Right),
            ("worst direction: found for exact", Align::Left),
            ("verdict", Align::Left),
        ]);
        for row in rows(judged) {
            let size = format!("{}x{}", row.size[0], row.size[1]);
            table.row(&[row.name, size, row.alpha, row.relmse, row.between, row.bias, row.worst, row.verdict]);
        }
        text += &format!("{table}");
    }
    if let Some(off) = judged.spot_check {
        text += &format!(
            "The integrals agree with adaptive cubature within {off:.0e} at three directions of the worst level.\n"
        );
    }
    if let Some(dfg) = &judged.dfg {
        text += &format!(
            "DFG table: max error {:.2e}, rms {:.1e}, worst at n·v {:.3}, perceptual roughness {:.3} of {} texels: {}\n",
            dfg.max_error, dfg.rms, dfg.worst.x, dfg.worst.y, dfg.count, dfg.verdict
        );
    }
    if let Some(sh) = &judged.sh {
        text += &format!(
            "SH: relmse {:.2e} of its irradiance, bias {:+.2} %, largest error of a coefficient {:.2e} of the largest: {}\n",
            sh.errors.relmse,
            100.0 * sh.errors.bias_rel,
            sh.max_error,
            sh.verdict
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
    text
}

/// Formats the scores of maps.
pub fn rows(judged: &Judged) -> Vec<Row> {
    let numbered = judged.levels.iter().enumerate().map(|(k, score)| (k.to_string(), score));
    let all = numbered.chain(judged.irradiance.iter().map(|score| ("irradiance".to_owned(), score)));
    let mean = |rgb: DVec3| rgb.element_sum() / 3.0;
    let row = |(name, score): (String, &LevelScore)| {
        let worst = &score.worst;
        let ([x, y, z], [face, column, row]) = (worst.direction.to_array(), worst.texel);
        let values = format!("{:.3} for {:.3}", mean(worst.found), mean(worst.exact));
        Row {
            name,
            size: score.size,
            alpha: format!("{:.4}", score.alpha),
            relmse: format!("{:.2e}", score.errors.relmse),
            between: score.between.map_or_else(String::new, |relmse| format!("{relmse:.2e}")),
            log: score.errors.relmse.max(1e-6).log10(),
            bias: format!("{:+.2}", 100.0 * score.errors.bias_rel),
            worst: format!("({x:.2}, {y:.2}, {z:.2}), face {face} texel {column},{row}: {values}"),
            verdict: score.verdict.clone(),
        }
    };
    all.map(row).collect()
}

pub fn as_json(environment: &str, preset: &str, judged: &Judged) -> Value {
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
