//! Answers by the axis and in the words that an experiment names, for runs with known numbers.

use super::asked::digest;
use super::paper::{Made, column, finished, numbers};
use splitsum::experiment::axis::Point;
use splitsum::study::finished::Finished;
use splitsum::study::frame::Frame;
use splitsum::study::questions::{Finding, QUESTIONS, answers};

/// Errors that grow with alpha and are a quarter for dielectrics.
fn made(point: &Point) -> Option<Made> {
    let f0 = if point.get("f0").to_string() == "1" {
        1.0
    } else {
        0.25
    };
    let own = if point.get("method").text() == "split-sum" {
        1.0
    } else {
        0.5
    };
    Some(Made::error(own * f0 * point.get("alpha").number()))
}

const METHODS: &str = "method = [\"split-sum\", \"split-sum-one\"]\nalbedo = [0]\n";

fn answered(head: &str, axes: &str) -> (Finished, Finding) {
    let text = format!(
        "{head}name = \"made\"\nsize = [16, 16]\nreference = {{ samples = 32, noise_share = 0 }}\n[axes]\ndiffuse = \
         [\"none\"]\n{METHODS}{axes}"
    );
    let run = super::paper::finished_of(&text, made);
    let mut answers = answers(&run, None);
    assert_eq!(answers.len(), 1);
    (run.clone(), answers.remove(0).finding)
}

#[test]
fn an_experiment_in_perceptual_roughness_is_answered_in_it() {
    let axes = "perceptual_roughness = [0.25, 0.5, 1]\nf0 = [1]\n";
    for question in ["error", "effect"] {
        let (_, found) = answered(&format!("asks = [\"{question}\"]\n"), axes);
        let digest_table = found.digest.as_ref().unwrap();
        assert!(
            digest_table
                .columns
                .contains(&"perceptual_roughness".to_owned()),
            "{:?}",
            digest_table.columns
        );
        assert!(
            digest_table
                .columns
                .iter()
                .all(|name| !name.contains("alpha")),
            "{:?}",
            digest_table.columns
        );
        assert_eq!(
            digest(&found)
                .iter()
                .take(3)
                .map(|row| &row[0])
                .collect::<Vec<_>>(),
            ["0.25", "0.5", "1"]
        );
        let figure = found.figure.unwrap();
        let words = format!("{} {figure:?}", found.sentences.markdown());
        assert!(
            !words.contains("alpha") && words.contains("roughness"),
            "{question}: {words}"
        );
        // The CSV has both columns, for programs.
        assert_eq!(numbers(&found.table, "perceptual_roughness")[..2].len(), 2);
        let squares: Vec<f64> = numbers(&found.table, "perceptual_roughness")
            .iter()
            .map(|rough| rough * rough)
            .collect();
        assert_eq!(numbers(&found.table, "alpha"), squares);
    }
    let (_, found) = answered("asks = [\"error\"]\n", axes);
    assert!(
        found
            .sentences
            .markdown()
            .contains("By perceptual_roughness it ranges from"),
        "{}",
        found.sentences.markdown()
    );
    assert!(
        found.sentences.markdown().contains("for roughness 0.25")
            && found.sentences.markdown().ends_with("3 roughnesses."),
        "{}",
        found.sentences.markdown()
    );
}

#[test]
fn the_rows_of_an_answer_are_values_of_the_axis_it_names() {
    let axes = "alpha = [0.25, 0.5]\nf0 = [1, 0.04]\n";
    let by = |question: &str| format!("asks = [{{ question = \"{question}\", by = \"f0\" }}]\n");
    let (_, found) = answered(&by("error"), axes);
    assert_eq!(found.digest.as_ref().unwrap().columns[0], "f0");
    // Means over alpha: √(0.25 · 0.5) and a quarter of it.
    let rows = digest(&found);
    assert_eq!([&rows[0][0], &rows[1][0]], ["0.04", "1"]);
    assert!(
        rows[0][1].starts_with("0.088 (") && rows[1][1].starts_with("0.35 ("),
        "{rows:?}"
    );
    assert!(
        found.sentences.markdown().contains("By f0 it ranges from"),
        "{}",
        found.sentences.markdown()
    );
    // Every question with such rows accepts the axis.
    for question in QUESTIONS.iter().filter(|question| question.has_rows) {
        let run = finished(&format!("{METHODS}{axes}"), made);
        let frame = Frame::new(&run, None);
        let by = Frame {
            digest_axis: splitsum::experiment::axis::AxisId::find("f0"),
            ..frame
        };
        let is_served = question.lack(&by.shape).is_none();
        if let Some(found) = is_served.then(|| (question.answer)(&by)).flatten() {
            let found = found.digest.unwrap();
            assert!(
                found.columns.iter().all(|name| !name.contains("alpha")),
                "{}: {:?}",
                question.name,
                found.columns
            );
        }
    }
}

/// The most important axes are in every table, swept or not.
#[test]
fn columns_of_answers_do_not_depend_on_the_sweep() {
    let (_, one) = answered("asks = [\"effect\"]\n", "alpha = [0.25]\n");
    let (_, swept) = answered(
        "asks = [\"effect\"]\n",
        "alpha = [0.25, 0.5]\nf0 = [1, 0.04]\nbrdf = [\"ggx\", \"phong\"]\n",
    );
    assert_eq!(one.table.columns, swept.table.columns);
    let always = [
        "weight",
        "environment",
        "brdf",
        "alpha",
        "perceptual_roughness",
        "f0",
    ];
    assert_eq!(one.table.columns[..6], always);
    assert_eq!(column(&one.table, "brdf"), ["ggx"]);
    assert_eq!(
        [
            numbers(&one.table, "alpha"),
            numbers(&one.table, "perceptual_roughness")
        ],
        [[0.25], [0.5]]
    );
}
