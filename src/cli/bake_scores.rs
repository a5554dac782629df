//! Output of `splitsum check-bake`: text and rows of a page.

use glam::DVec3;
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
