//! What a surface keeps of the light in a white furnace.
//!
//! A furnace is a constant environment over a surface that reflects all it gets (F = 1, no metal's colour, no light lost in a diffuse
//! term), held against a white Lambert surface, which shows exactly what arrives. The relative bias of the image is then the energy that a
//! method creates (above 0) or loses.

use super::run_folder::RunFolder;
use super::slope::T_NORMAL;
use super::study::{Row, Study};

/// The energy balance of one way of making the image.
#[derive(Clone, Debug, PartialEq)]
pub struct Furnace {
    /// Values on the case axes.
    pub key: Vec<String>,
    /// "reference 2048".
    pub method: String,
    /// Energy that leaves over energy that arrives, minus 1, over the whole surface.
    pub change: f64,
    /// 95 % interval of it, by the noise of what judges it; `None` where that is not known.
    pub interval: Option<[f64; 2]>,
    /// The bins of `n_dot_v` that lose most and create most, each with its ends.
    pub extremes: Option<[(f64, [f64; 2]); 2]>,
    /// Every bin of `n_dot_v` that has pixels, grazing first: its change and its ends.
    pub bins: Vec<(f64, [f64; 2])>,
}

/// Axes of a furnace with the one value that each must have.
const WHITE: [(&str, f64); 3] = [("f0", 1.0), ("environment_scale", 1.0), ("metallic", 0.0)];

/// The balance of every image of furnaces, in the order of the rows; empty for other experiments.
pub fn furnace(study: &Study, runs: &[RunFolder]) -> Vec<Furnace> {
    let is_white = |row: &Row| {
        let is_one = |(name, wanted): &(&str, f64)| {
            let text = study.value(row, name);
            text.is_empty() || text.parse::<f64>().is_ok_and(|value| value == *wanted)
        };
        study.value(row, "environment") == CONSTANT && WHITE.iter().all(is_one)
    };
    let is_lambert_judged = |row: &Row| runs.get(row.run).is_some_and(|run| run.text("/reference/method") == "none");
    let rows = study.images();
    if !rows.iter().all(|row| is_white(row) && is_lambert_judged(row)) {
        return Vec::new();
    }
    let axes = study.case_axes();
    let balance = |row: &&Row| {
        let change = row.bias.filter(|bias| bias.is_finite())?;
        let bins: Vec<(f64, [f64; 2])> =
            row.bins.iter().filter(|bin| bin.bias.is_finite()).map(|bin| (bin.bias, [bin.lo, bin.hi])).collect();
        let least = bins.iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
        let most = bins.iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(Furnace {
            key: super::curves::key(row, &axes),
            method: study.method_label(row),
            change,
            interval: row.bias_noise.map(|noise| [-T_NORMAL, T_NORMAL].map(|z| change + z * noise)),
            extremes: Some([*least, *most]),
            bins,
        })
    };
    rows.iter().filter(|row| study.value(row, "method") != "none").filter_map(balance).collect()
}

/// The environment of a furnace.
const CONSTANT: &str = "builtin:constant";
