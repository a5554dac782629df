//! What an experiment asks, and by which metric.

use super::config::{assert_faults, faults};
use splitsum::experiment::Plan;
use std::path::Path;

/// An experiment with these keys.
fn experiment(keys: &str) -> String {
    format!("{keys}name = \"x\"\n[axes]\nmethod = [\"split-sum\"]\n")
}

#[test]
fn questions_are_distinct_names_with_places_and_the_metric_is_a_listed_one() {
    let of = |keys: &str| Plan::from_text(Path::new("e.toml"), &experiment(keys), &[]).unwrap();
    let (plain, plan) = (of(""), of("asks = [\"convergence\", \"break-even\"]\nmetric = \"flip\"\n"));
    assert_eq!((plain.config.asks.len(), plain.config.metric), (0, splitsum::metrics::HEADLINE));
    assert_eq!((plan.config.asks[1].0.as_str(), plan.config.metric), ("break-even", "flip"));
    // What is asked of the rows is no part of them.
    assert_eq!(plan.hash, plain.hash);
    // A later room knows which questions there are, and tells of one as any other fault.
    let mut found = plan.config.faults();
    plan.config.asks.iter().for_each(|(name, place)| found.add(place, format!("asks: {name} is unknown")));
    let lines = found.into_result().unwrap_err().lines();
    assert_eq!(lines, ["e.toml:1:9: asks: convergence is unknown", "e.toml:1:24: asks: break-even is unknown"]);

    let text = experiment("asks = [\"a\", 1, \"a\"]\nmetric = \"flop\"\n");
    assert_faults(
        &faults(&text, &[]),
        &[
            "e.toml:1:14: asks: 1 is not text",
            "e.toml:1:17: asks: a stands twice",
            "e.toml:2:10: metric: \"flop\" is not a metric; did you mean \"flip\"?",
        ],
    );
    for (asks, shown) in [("[]", "[]"), ("\"a\"", "\"a\"")] {
        let found = faults(&experiment(&format!("asks = {asks}\n")), &[]);
        assert_faults(&found, &[&format!("e.toml:1:8: asks: {shown} is not a list of at least one name")]);
    }
}
