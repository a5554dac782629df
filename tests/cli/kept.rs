//! Errors of cells with a value of their own on every axis, against kept ones.

use super::{ok, splitsum, stdout};
use std::path::Path;

/// Another version of the driver rounds otherwise.
const WITHIN: f64 = 0.02;

/// A slip in a term, a table or a key of any axis moves a number. Other drivers draw other edges.
#[test]
fn errors_over_every_axis_are_kept() {
    let (dir, golden) = (tempfile::tempdir().unwrap(), Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden"));
    if !stdout(&splitsum(dir.path(), &["devices"])).contains("llvmpipe") {
        return eprintln!("skipped: kept on lavapipe");
    }
    let experiment = golden.join("all_axes.toml");
    ok(dir.path(), &["run", experiment.to_str().unwrap(), "--out", "run"]);
    let read = |path: &Path| -> Vec<Vec<String>> {
        let mut reader = csv::Reader::from_path(path).unwrap();
        let names = reader.headers().unwrap().clone();
        let is_score =
            |name: &str| ["rmse", "relmse", "bias_rel", "flip", "lag_bias", "flicker", "method"].contains(&name);
        let row = |row: csv::StringRecord| {
            names.iter().zip(&row).filter(|(name, _)| is_score(name)).map(|(_, x)| x.to_owned()).collect()
        };
        reader.records().map(|record| row(record.unwrap())).collect()
    };
    let (found, kept) = (read(&dir.path().join("run/errors.csv")), read(&golden.join("all_axes.csv")));
    assert_eq!(found.len(), kept.len());
    for (row, (found, kept)) in found.iter().zip(&kept).enumerate() {
        let is_near = |(found, kept): (&String, &String)| match (found.parse::<f64>(), kept.parse::<f64>()) {
            (Ok(found), Ok(kept)) => (found - kept).abs() <= WITHIN * kept.abs().max(1e-6),
            _ => found == kept,
        };
        assert!(found.iter().zip(kept).all(is_near), "row {row}: {found:?}, kept {kept:?}");
    }
}
