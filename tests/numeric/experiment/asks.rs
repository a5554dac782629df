//! What an experiment asks, and by which metric.

use super::config::{assert_faults, faults};
use splitsum::experiment::Plan;
use splitsum::experiment::axis::ALPHA;
use splitsum::study::questions::check;
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
    assert_eq!((plan.config.asks[1].question.as_str(), plan.config.metric), ("break-even", "flip"));
    // What is asked of the rows is no part of them.
    assert_eq!(plan.hash, plain.hash);
    // A later room knows which questions there are, and tells of one as any other fault.
    let mut found = plan.config.faults();
    for ask in &plan.config.asks {
        found.add(&ask.place, format!("asks: {} is unknown", ask.question));
    }
    let lines = found.into_result().unwrap_err().lines();
    assert_eq!(lines, ["e.toml:1:9: asks: convergence is unknown", "e.toml:1:24: asks: break-even is unknown"]);

    let text = experiment("asks = [\"a\", 1, \"a\"]\nmetric = \"flop\"\n");
    assert_faults(
        &faults(&text, &[]),
        &[
            "e.toml:1:14: asks: 1 is neither a name nor { question = ..., by = ... }",
            "e.toml:1:17: asks: a is listed twice",
            "e.toml:2:10: metric: \"flop\" is not a metric; did you mean \"flip\"?",
        ],
    );
    for (asks, shown) in [("[]", "[]"), ("\"a\"", "\"a\"")] {
        let found = faults(&experiment(&format!("asks = {asks}\n")), &[]);
        assert_faults(&found, &[&format!("e.toml:1:8: asks: {shown} is not a list of at least one name")]);
    }
}

#[test]
fn a_question_may_name_the_axis_of_its_rows() {
    let text = "asks = [\"error\", { question = \"effect\", by = \"perceptual_roughness\" }]\n";
    let plan = Plan::from_text(Path::new("e.toml"), &experiment(text), &[]).unwrap();
    let asked: Vec<_> = plan.config.asks.iter().map(|ask| (&*ask.question, ask.by.as_ref().map(|by| by.0))).collect();
    assert_eq!(asked, [("error", None), ("effect", Some(ALPHA))]);

    let text =
        experiment("asks = [{ question = \"a\", by = \"apha\" }, { by = \"f0\" }, { question = 1, rows = 2 }]\n");
    let found = faults(&text, &[]);
    assert_faults(
        &found,
        &[
            "e.toml:1:32: asks.by: \"apha\" is not an axis; did you mean \"alpha\"?",
            "e.toml:1:42: asks.question is missing",
            "e.toml:1:70: asks.question: 1 is not text",
            "e.toml:1:73: asks.rows is unknown",
        ],
    );
}

/// What the rows of an answer can be is known before anything is rendered.
#[test]
fn an_axis_that_makes_no_rows_is_refused() {
    let faults_of = |asks: &str| {
        let text = format!(
            "name = \"x\"\nasks = [{asks}]\n[axes]\nmethod = [\"sampled\", \"sampled-vndf\"]\nsamples = [1, 4, 16]\nf0 = [1, 0.04]\n\
             exposure = [1, 2]\nperceptual_roughness = [0.5, 1]\n"
        );
        let plan = Plan::from_text(Path::new("e.toml"), &text, &[]).unwrap();
        check(&plan.config).err().map_or_else(Vec::new, |error| error.lines())
    };
    assert_eq!(faults_of(r#"{ question = "effect", by = "f0" }, "error""#), [""; 0]);
    assert_eq!(
        faults_of(r#"{ question = "effect", by = "brdf" }"#),
        ["e.toml:2:37: asks.by: brdf has fewer than two values; expected perceptual_roughness, f0"]
    );
    assert_eq!(
        faults_of(r#"{ question = "effect", by = "samples" }"#),
        ["e.toml:2:37: asks.by: samples does not distinguish cases; expected perceptual_roughness, f0"]
    );
    assert_eq!(
        faults_of(r#"{ question = "visibility", by = "f0" }"#),
        ["e.toml:2:41: asks.by: the rows of visibility are not values of an axis; leave it out"]
    );
}
