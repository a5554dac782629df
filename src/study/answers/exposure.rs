//! Error after the tone curve: at which exposure and contrast a difference of linear values shows, and where the curve hides it.
//!
//! The measure is FLIP [Andersson20], the difference that a viewer notices when the two images are flipped in place, from 0 (none) to 1.
//! Its authors give no limit of visibility for a mean over an image; [`VISIBLE_FROM`] is this project's convention, drawn and written
//! wherever it is used.

use super::study::Study;
use crate::runner::statistics::spread;
use std::collections::BTreeSet;

/// Mean FLIP from which a difference is called visible. On this project's images it is about where flipping two of them in place
/// begins to show a change everywhere rather than in single spots.
pub const VISIBLE_FROM: f64 = 0.05;

/// The display error of one method at one setting of the tone curve: middle of everything else that is swept.
#[derive(Clone, Debug, PartialEq)]
pub struct Visibility {
    /// "sampled 16".
    pub method: String,
    pub exposure: f64,
    pub contrast: f64,
    pub n: usize,
    pub lower_quartile: f64,
    pub median: f64,
    pub upper_quartile: f64,
}

impl Visibility {
    pub fn is_visible(&self) -> bool {
        self.median >= VISIBLE_FROM
    }
}

/// Where a method's difference is largest and where it is hidden, at one contrast.
#[derive(Clone, Debug, PartialEq)]
pub struct Hiding {
    pub method: String,
    pub contrast: f64,
    /// Exposure of the largest difference, and that difference.
    pub peak: (f64, f64),
    /// The tried exposures at which the difference is below [`VISIBLE_FROM`].
    pub hidden_at: Vec<f64>,
    /// All tried exposures, ascending.
    pub tried: Vec<f64>,
}

/// One entry a method, contrast and exposure, ascending by the latter two; empty where neither is swept.
pub fn visibility(study: &Study) -> Vec<Visibility> {
    if study.display_axes().is_empty() {
        return Vec::new();
    }
    let number = |row, axis| study.value(row, axis).parse::<f64>().unwrap_or(1.0);
    let mut seen = BTreeSet::new();
    let methods: Vec<String> = study.rows.iter().map(|row| study.method_label(row)).collect();
    let methods = methods.into_iter().filter(|method| seen.insert(method.clone()));
    let mut found = Vec::new();
    for method in methods {
        let own: Vec<_> = study.rows.iter().filter(|row| study.method_label(row) == method).collect();
        let mut settings: Vec<(f64, f64)> =
            own.iter().map(|r| (number(r, "contrast"), number(r, "exposure"))).collect();
        settings.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        settings.dedup();
        for (contrast, exposure) in settings {
            let at =
                own.iter().filter(|row| (number(row, "contrast"), number(row, "exposure")) == (contrast, exposure));
            let errors: Vec<f64> = at.filter_map(|row| row.display_error).collect();
            if let Some(spread) = spread(&errors) {
                found.push(Visibility {
                    method: method.clone(),
                    exposure,
                    contrast,
                    n: spread.n,
                    lower_quartile: spread.lower_quartile,
                    median: spread.median,
                    upper_quartile: spread.upper_quartile,
                });
            }
        }
    }
    found
}

/// Per method and contrast; only contrasts at which more than one exposure was tried.
pub fn hiding(visibility: &[Visibility]) -> Vec<Hiding> {
    let mut found: Vec<Hiding> = Vec::new();
    for one in visibility {
        let index = found.iter().position(|h| h.method == one.method && h.contrast == one.contrast);
        let index = index.unwrap_or_else(|| {
            let (method, contrast) = (one.method.clone(), one.contrast);
            found.push(Hiding { method, contrast, peak: (one.exposure, one.median), hidden_at: vec![], tried: vec![] });
            found.len() - 1
        });
        let hiding = &mut found[index];
        hiding.tried.push(one.exposure);
        if one.median > hiding.peak.1 {
            hiding.peak = (one.exposure, one.median);
        }
        if !one.is_visible() {
            hiding.hidden_at.push(one.exposure);
        }
    }
    found.retain(|hiding| hiding.tried.len() > 1);
    found
}
