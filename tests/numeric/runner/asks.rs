//! What an experiment asks, and by which metric.

use super::config::{assert_faults, faults};
use splitsum::runner::Plan;
use std::path::Path;

/// An experiment with these keys.
fn experiment(keys: &str) -> String {
    format!("{keys}name = \"x\"\n[axes]\nmethod = [\"split-sum\"]\n")
}

const ASKING: &str = "asks = [\"convergence\", \"break-even\"]\nmetric = \"flip\"\n";

#[test]
fn questions_keep_their_order_and_their_places_and_the_metric_is_a_listed_one() {
    let plain = Plan::from_text(Path::new("e.toml"), &experiment(""), &[]).unwrap();
    assert!(plain.config.asks.is_empty());
    assert_eq!(plain.config.metric, splitsum::metrics::HEADLINE);
    let plan = Plan::from_text(Path::new("e.toml"), &experiment(ASKING), &[]).unwrap();
    let names: Vec<&str> = plan.config.asks.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!((names, plan.config.metric), (vec!["convergence", "break-even"], "flip"));
    // What is asked of the rows is no part of them.
    assert_eq!(plan.hash, plain.hash);
    // A later room knows which questions there are, and tells of one as any other fault.
    let mut faults = plan.config.faults();
    plan.config.asks.iter().for_each(|(name, place)| faults.add(place, format!("asks: {name} is unknown")));
    faults.add(&plan.config.metric_place, "metric: odd");
    assert_eq!(
        faults.into_result().unwrap_err().lines(),
        [
            "e.toml:1:9: asks: convergence is unknown",
            "e.toml:1:24: asks: break-even is unknown",
            "e.toml:2:10: metric: odd"
        ]
    );
}

#[test]
fn questions_are_distinct_names_and_an_unknown_metric_has_a_nearest_one() {
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
