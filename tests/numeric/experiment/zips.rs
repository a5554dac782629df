//! `--set` of zipped axes keeps rows whole.

use super::planned;

const ZIPPED: &str = "name = \"x\"\n[axes]\nbrdf = [\"ggx\", \"phong\"]\nalpha = [0.1, 0.5, 1]\nsamples = [4, 16, 64]\n\
                      [[zip]]\naxes = [\"alpha\", \"samples\"]\n";

/// Rows of model, alpha and samples, or the faults.
fn rows(overrides: &[&str]) -> Result<Vec<String>, String> {
    let plan = planned(ZIPPED, overrides).map_err(|error| error.to_string())?;
    let row = |cell: &splitsum::experiment::Cell| {
        ["brdf", "alpha", "samples"].map(|axis| cell.point.get(axis).to_string()).join(" ")
    };
    Ok(plan.cells.iter().map(row).collect())
}

#[test]
fn a_value_of_one_axis_keeps_its_rows_and_the_others_follow() {
    let whole = rows(&[]).unwrap();
    assert_eq!(whole, ["ggx 0.1 4", "ggx 0.5 16", "ggx 1 64", "phong 0.1 4", "phong 0.5 16", "phong 1 64"]);
    assert_eq!(rows(&["alpha=1,0.1"]).unwrap(), ["ggx 0.1 4", "ggx 1 64", "phong 0.1 4", "phong 1 64"]);
    assert_eq!(rows(&["samples=16", "brdf=phong"]).unwrap(), ["phong 0.5 16"]);
    // Setting all of them gives new rows.
    assert_eq!(rows(&["samples=9,2", "alpha=0.3,0.4", "brdf=ggx"]).unwrap(), ["ggx 0.3 9", "ggx 0.4 2"]);
}

#[test]
fn a_value_of_no_row_is_refused_with_the_rows() {
    let fault = rows(&["alpha=0.5,0.3"]).unwrap_err();
    assert_eq!(
        fault,
        "--set alpha: axes.alpha: 0.3 is in no row of the file's [[zip]], whose axes vary together; choose from 0.1, 0.5, 1, or set all of alpha, samples"
    );
    // An invalid value is the only fault reported.
    let fault = rows(&["alpha=7"]).unwrap_err();
    assert_eq!(fault, "--set alpha: axes.alpha: 7 is outside (0, 1]");
    let fault = rows(&["alpha=0.3,0.4", "samples=1"]).unwrap_err();
    assert!(fault.ends_with("zip: alpha has 2 values, samples has 1 value; expected as many for each"), "{fault}");
}
