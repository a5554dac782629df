//! What an experiment asks, and by which metric.

use splitsum::experiment::Plan;
use splitsum::experiment::axis::ALPHA;
use splitsum::study::questions::check;
use std::path::Path;

fn plan(keys: &str, axes: &str) -> Plan {
    Plan::from_text(Path::new("e.toml"), &format!("name = \"x\"\n{keys}[axes]\n{axes}\n"), &[]).unwrap()
}

#[test]
fn asks_have_a_metric_and_rows_and_change_no_cell() {
    let axes = "method = [\"split-sum\"]";
    let asks = "asks = [\"error\", { question = \"effect\", by = \"perceptual_roughness\" }]\nmetric = \"flip\"\n";
    let (plain, asking) = (plan("", axes), plan(asks, axes));
    assert_eq!((plain.config.asks.len(), plain.config.metric), (0, splitsum::metrics::HEADLINE));
    let asked: Vec<_> = asking.config.asks.iter().map(|ask| (&*ask.question, ask.by.as_ref().map(|by| by.0))).collect();
    assert_eq!((asked, asking.config.metric), (vec![("error", None), ("effect", Some(ALPHA))], "flip"));
    // What is asked of the rows is not part of them.
    assert_eq!(asking.hash, plain.hash);
}

/// What the rows of an answer can be is known before anything is rendered.
#[test]
fn a_question_that_cannot_be_answered_is_refused() {
    let axes = "method = [\"sampled\", \"sampled-vndf\"]\nsamples = [1, 4, 16]\nf0 = [1, 0.04]\nexposure = [1, 2]\n\
                perceptual_roughness = [0.5, 1]";
    let faults = |asks: &str| {
        let plan = plan(&format!("asks = [{asks}]\n"), axes);
        check(&plan.config).err().map_or_else(Vec::new, |error| error.lines())
    };
    assert_eq!(faults(r#"{ question = "effect", by = "f0" }, "error""#), [""; 0]);
    for (asks, place) in [
        (r#""error", "unknown""#, "e.toml:2:18: asks: \"unknown\""),
        (r#"{ question = "effect", by = "brdf" }"#, "e.toml:2:37: asks.by: brdf"),
        (r#"{ question = "effect", by = "samples" }"#, "e.toml:2:37: asks.by: samples"),
        (r#"{ question = "visibility", by = "f0" }"#, "e.toml:2:41: asks.by: "),
    ] {
        let found = faults(asks);
        assert!(found.len() == 1 && found[0].starts_with(place), "{place}: {found:?}");
    }
}
