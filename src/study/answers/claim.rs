//! Do 30 to 40 samples suffice?
//!
//! Source document 0 calls 30 to 40 samples a pixel "the proper size". An experiment that tries these counts is asked two things: do they
//! beat the method without samples that stands beside them, and is what is left below what a viewer notices ([`VISIBLE_FROM`])?

use super::curves::{fits, key};
use super::exposure::VISIBLE_FROM;
use super::slope::mean_95;
use super::study::{Row, Study};
use crate::runner::statistics::{Spread, spread};

/// The counts of the claim.
pub const CLAIMED: [u32; 2] = [30, 40];

/// A sampling method at one count.
#[derive(Clone, Debug, PartialEq)]
pub struct Sufficiency {
    /// A BRDF model, or `None` for all of them.
    pub model: Option<String>,
    pub method: String,
    pub samples: u32,
    /// Headline error over the cases.
    pub error: Spread,
    /// Against the method without samples, where there is one.
    pub against: Option<Against>,
    /// Mean FLIP over the cases, at the plain tone curve, and how many of them are visible.
    pub flip: Option<Spread>,
    pub visible: usize,
    /// Of how many rows bias² outweighs the variance, and how many rows tell.
    pub mostly_bias: [usize; 2],
}

/// Errors over those of a method without samples in the same case.
#[derive(Clone, Debug, PartialEq)]
pub struct Against {
    pub fixed: String,
    /// Geometric mean of the ratios.
    pub ratio: f64,
    /// Student's 95 % interval in logarithms; infinite for one case.
    pub interval: [f64; 2],
    pub n: usize,
    pub better: usize,
}

/// Every sampling method at every count, over all models and then by model; empty where the claimed counts were not tried.
pub fn sufficiency(study: &Study) -> Vec<Sufficiency> {
    let tried = |n: &u32| study.axis("samples").is_some_and(|axis| study.axes[axis].values.contains(&n.to_string()));
    if !CLAIMED.iter().all(tried) {
        return Vec::new();
    }
    let rows: Vec<&Row> = study.rows.iter().filter(|row| row.error.is_some() && is_plain(study, row)).collect();
    let mut models: Vec<Option<&str>> = vec![None];
    if let Some(axis) = study.axis("brdf").filter(|axis| study.axes[*axis].values.len() > 1) {
        models
            .extend(study.axes[axis].values.iter().filter(|value| !value.is_empty()).map(|value| Some(value.as_str())));
    }
    let mut ways: Vec<(&str, u32)> = Vec::new();
    for row in &rows {
        if let Ok(samples) = study.value(row, "samples").parse() {
            let way = (study.value(row, "method"), samples);
            if !ways.contains(&way) {
                ways.push(way);
            }
        }
    }
    let axes = study.case_axes();
    let fixed: Vec<&Row> = rows
        .iter()
        .copied()
        .filter(|row| study.value(row, "samples").is_empty() && study.value(row, "method") != "none")
        .collect();
    let of = |model: Option<&str>, (method, samples): (&str, u32)| {
        let own = rows.iter().filter(|row| {
            study.value(row, "method") == method
                && study.value(row, "samples").parse() == Ok(samples)
                && model.is_none_or(|model| study.value(row, "brdf") == model)
        });
        let own: Vec<&Row> = own.copied().collect();
        let flips: Vec<f64> = own.iter().filter_map(|row| row.display_error).collect();
        // Point sets of one case share all that makes cases differ: their mean logarithm counts once.
        let mut cases: Vec<(Vec<String>, Vec<f64>)> = Vec::new();
        for row in &own {
            let key = key(row, &axes);
            let partner = fixed.iter().find(|other| other.run == row.run && fits(&self::key(other, &axes), &key));
            let (Some(partner), Some(error)) = (partner, row.error) else { continue };
            let log = (error / partner.error.unwrap_or(f64::NAN)).ln();
            match cases.iter_mut().find(|case| case.0 == key) {
                Some(case) => case.1.push(log),
                None => cases.push((key, vec![log])),
            }
        }
        let logs: Vec<f64> = cases.iter().map(|(_, logs)| logs.iter().sum::<f64>() / logs.len() as f64).collect();
        let against = mean_95(&logs).zip(fixed.first()).map(|((mean, half), fixed)| Against {
            fixed: study.value(fixed, "method").to_owned(),
            ratio: mean.exp(),
            interval: [(mean - half).exp(), (mean + half).exp()],
            n: logs.len(),
            better: logs.iter().filter(|log| **log < 0.0).count(),
        });
        Some(Sufficiency {
            model: model.map(str::to_owned),
            method: method.to_owned(),
            samples,
            error: spread(&own.iter().filter_map(|row| row.error).collect::<Vec<_>>())?,
            against,
            visible: flips.iter().filter(|flip| **flip >= VISIBLE_FROM).count(),
            flip: spread(&flips),
            mostly_bias: [told(&own).filter(|is| *is).count(), told(&own).count()],
        })
    };
    models.iter().flat_map(|model| ways.iter().filter_map(|way| of(*model, *way)).collect::<Vec<_>>()).collect()
}

/// Whether the error of each row is mostly bias, where that is known.
fn told<'r>(rows: &'r [&Row]) -> impl Iterator<Item = bool> + 'r {
    rows.iter().filter_map(|row| row.is_mostly_bias)
}

/// Whether a row has the plain tone curve, or the experiment has only one.
fn is_plain(study: &Study, row: &Row) -> bool {
    let is_one = |&axis: &usize| {
        let values = &study.axes[axis].values;
        row.axes[axis] == PLAIN || !values.iter().any(|value| value == PLAIN)
    };
    study.display_axes().iter().all(is_one)
}

/// Exposure and contrast of the plain tone curve.
const PLAIN: &str = "1";
