//! Large or hostile experiment files: their cost, and the messages about them.

use crate::cpu_time;
use splitsum::experiment::fault::FAULTS_SHOWN;
use splitsum::experiment::{ConfigError, Plan};
use std::path::Path;
use std::time::Duration;

/// Many times the usual time: quadratic time would take ten times as long.
const QUICK: Duration = Duration::from_secs(5);

fn planned(text: &str) -> Result<Plan, ConfigError> {
    let started = cpu_time();
    let plan = Plan::from_text(Path::new("large.toml"), text, &[]);
    let taken = cpu_time() - started;
    assert!(taken < QUICK, "{taken:?} for {text:.60}");
    plan
}

#[test]
fn the_first_faults_are_shown_and_the_others_counted() {
    let keys = |count: usize| {
        (0..count)
            .map(|i| format!("k{i} = 1\n"))
            .collect::<String>()
    };
    for (text, count) in [
        (
            format!("name = \"x\"\naxes.alpha = [0.1]\n{}", keys(100_000)),
            100_000,
        ),
        (
            format!(
                "name = \"x\"\naxes.alpha = [0.1]\n{}",
                "[[exclude]]\n".repeat(20_000)
            ),
            40_000,
        ),
    ] {
        let error = planned(&text).unwrap_err();
        assert_eq!(
            (error.faults.len(), error.faults.len() + error.more),
            (FAULTS_SHOWN, count),
            "{text:.40}"
        );
        assert!(
            error
                .to_string()
                .ends_with(&format!("\nand {} more", count - FAULTS_SHOWN)),
            "{error}"
        );
    }
    let error = planned(&format!(
        "name = \"x\"\naxes.alpha = [0.1]\n{}",
        keys(FAULTS_SHOWN)
    ))
    .unwrap_err();
    assert_eq!((error.faults.len(), error.more), (FAULTS_SHOWN, 0));
    let long = planned(&format!(
        "name = \"{}\"\naxes.alpha = [0.1]\n",
        "n".repeat(1 << 20)
    ))
    .unwrap_err()
    .to_string();
    assert!(long.len() < 4000 && long.ends_with('…'));
}

#[test]
fn large_sweeps_are_planned_at_once() {
    let sweep = |counts: u32, alphas: u32, rest: &str| {
        format!(
            "name = \"x\"\nsize = [8, 8]\n[axes]\nmethod = [\"sampled\"]\nsamples = {:?}\nalpha = \
             {:?}\n{rest}",
            (1..=counts).collect::<Vec<_>>(),
            (1..=alphas)
                .map(|k| f64::from(k) / f64::from(alphas))
                .collect::<Vec<_>>()
        )
    };
    assert_eq!(planned(&sweep(50, 100, "")).unwrap().cells.len(), 5000);
    // A long axis, whose values are compared with each other.
    assert_eq!(planned(&sweep(20_000, 2, "")).unwrap().cells.len(), 40_000);
    assert!(
        planned(&sweep(1000, 1000, ""))
            .unwrap_err()
            .to_string()
            .contains("1000000 combinations; at most")
    );
    let counts: Vec<String> = (1..=20_000).map(|count| count.to_string()).collect();
    let exclusion = format!(
        "[[exclude]]\nwhy = \"slow\"\nsamples = [{}]\n",
        counts.join(", ")
    );
    let error = planned(&sweep(20_000, 2, &exclusion))
        .unwrap_err()
        .to_string();
    assert!(error.contains("20000 excluded values"), "{error}");
}

#[test]
fn the_name_must_suit_a_folder() {
    for (name, is_good) in [
        ("-rf".to_owned(), false),
        (".hidden".to_owned(), false),
        ("a/b".to_owned(), false),
        ("a\\u0007".to_owned(), false),
        (String::new(), false),
        ("n".repeat(101), false),
        ("n".repeat(100), true),
        ("_a-1.2".to_owned(), true),
    ] {
        let found = planned(&format!("axes.alpha = [0.1]\nname = \"{name}\"\n"));
        assert_eq!(found.is_ok(), is_good, "{name}");
        found
            .err()
            .into_iter()
            .for_each(|e| assert!(e.to_string().starts_with("large.toml:2:8: name: "), "{e}"));
    }
}
