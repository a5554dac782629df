//! Errors of cells with a value of their own on every axis, against kept ones.

use super::{ok, splitsum, stdout};
use splitsum::table::csv::Table;
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
    ok(dir.path(), &["run", golden.join("all_axes.toml").to_str().unwrap(), "--out", "run"]);
    let kept = Table::read(&golden.join("all_axes.csv")).unwrap();
    let found = Table::read(&dir.path().join("run/errors.csv")).unwrap();
    assert_eq!(found.rows.len(), kept.rows.len());
    for (column, name) in kept.columns.iter().enumerate() {
        let place = found.column(name).unwrap();
        for (row, (found, kept)) in found.rows.iter().zip(&kept.rows).enumerate() {
            let (found, kept) = (&found[place], &kept[column]);
            let is_near = match (found.parse::<f64>(), kept.parse::<f64>()) {
                (Ok(found), Ok(kept)) => (found - kept).abs() <= WITHIN * kept.abs().max(1e-6),
                _ => found == kept,
            };
            assert!(is_near, "row {row}, {name}: {found}, kept {kept}");
        }
    }
}
