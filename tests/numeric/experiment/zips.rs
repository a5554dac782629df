//! `--set` of zipped axes.

use super::planned;

const ZIPPED: &str = "name = \"x\"\n[axes]\nbrdf = [\"ggx\", \"phong\"]\nalpha = [0.1, 0.5, \
                      1]\nsamples = [4, 16, 64]\n\
                      [[zip]]\naxes = [\"alpha\", \"samples\"]\n";

/// Rows of model, alpha and samples, or the faults.
fn rows(overrides: &[&str]) -> Result<Vec<String>, String> {
    let plan = planned(ZIPPED, overrides).map_err(|error| error.to_string())?;
    let row = |cell: &splitsum::experiment::Cell| {
        ["brdf", "alpha", "samples"]
            .map(|axis| cell.point.get(axis).to_string())
            .join(" ")
    };
    Ok(plan.cells.iter().map(row).collect())
}

#[test]
fn zipped_axes_are_set_together() {
    let whole = rows(&[]).unwrap();
    assert_eq!(
        whole,
        [
            "ggx 0.1 4",
            "ggx 0.5 16",
            "ggx 1 64",
            "phong 0.1 4",
            "phong 0.5 16",
            "phong 1 64"
        ]
    );
    assert_eq!(
        rows(&["samples=9,2", "alpha=0.3,0.4", "brdf=ggx"]).unwrap(),
        ["ggx 0.3 9", "ggx 0.4 2"]
    );
    assert_eq!(
        rows(&["samples=9,2,1", "brdf=ggx"]).unwrap(),
        ["ggx 0.1 9", "ggx 0.5 2", "ggx 1 1"]
    );
    // An invalid value is the only fault reported.
    let fault = rows(&["alpha=7,0.5,0.6"]).unwrap_err();
    assert_eq!(fault, "--set alpha: axes.alpha: 7 is outside [0.001, 1]");
    let fault = rows(&["alpha=0.3,0.4"]).unwrap_err();
    assert!(
        fault.ends_with("zip: alpha has 2 values, samples has 3 values; expected as many for each"),
        "{fault}"
    );
}
