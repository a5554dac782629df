//! Runs without references: images for fits and pictures, which no answer scores.

use super::runs::{Bench, assert_like_whole, contents, invoke, log, plan, summary, written};
use splitsum::base::pixels::exr;
use splitsum::experiment::Plan;
use splitsum::experiment::plan::Source;
use splitsum::instrument::pipeline::Frame;
use splitsum::report::page::{PageOptions, PageRun, write};
use splitsum::run::Renderer;
use splitsum::run::estimate::Forecast;
use splitsum::run::images::N_DOT_V_LAYER;
use splitsum::run::shard::Shard;
use splitsum::run::split::split;
use splitsum::study::finished::Finished;
use splitsum::study::questions::{answers, check};
use std::path::Path;

const AXES: &str = r#"
size = [24, 24]
[axes]
environment = ["builtin:constant"]
brdf = ["ggx", "phong"]
method = ["reference", "split-sum"]
samples = [16]
alpha = [0.1, 0.5]
exposure = [1, 10]
"#;

fn experiment(head: &str) -> String {
    format!("name = \"unscored\"\n{head}{AXES}")
}

fn unscored() -> String {
    experiment("reference = \"none\"\n")
}

/// 2 models, 2 methods and 2 widths are 8 images; two exposures share each.
#[test]
fn each_image_is_rendered_once_and_nothing_is_scored() {
    let (bench, log) = (Bench::new(&unscored()), log());
    let outcome = bench.invoke(&log, usize::MAX).unwrap();
    assert!(outcome.failures.is_empty() && outcome.cell_count == 16);
    assert_eq!(log.borrow().renders.len(), 8);
    let errors = bench.table("errors.csv");
    let relmse = errors.column("relmse").unwrap();
    let verdict = errors.column("verdict").unwrap();
    assert_eq!(errors.rows.len(), 16);
    for row in &errors.rows {
        assert_eq!(
            [row[verdict].as_str(), row[relmse].as_str()],
            ["unscored", ""]
        );
    }
    assert!(!bench.path("errors_by_n_dot_v.csv").exists());
    let images = bench.table("images.csv");
    for name in ["reference", "reference_picture", "error"] {
        let column = images.column(name).unwrap();
        assert!(
            images.rows.iter().all(|row| row[column].is_empty()),
            "{name}"
        );
    }
    // 8 linear images and 16 tone-mapped ones.
    assert_eq!(bench.images().len(), 8 + 16);
    let run = Finished::read(bench.dir.path()).unwrap();
    assert!(!run.is_scored() && run.failed_count() == 0);
    assert!(run.cells.iter().all(|cell| cell.scores.is_none()));
}

#[test]
fn an_unscored_image_has_its_n_dot_v() {
    let bench = Bench::finished(&unscored());
    let plan = &bench.plan;
    let log = log();
    let frame: Frame = super::fake::Fake(log)
        .render(&plan.request(&plan.cells[0].point))
        .unwrap();
    let name = splitsum::run::images::linear_file(&plan.cells[0]);
    let path = bench.path(&format!("images/{name}"));
    let layer = exr::read_layer(&path, Some(N_DOT_V_LAYER)).unwrap();
    assert_eq!(exr::read(&path).unwrap().rgb, frame.radiance);
    for (texel, cosine) in layer.rgb.data.iter().zip(&frame.n_dot_v.data) {
        assert_eq!(*texel, [*cosine; 3]);
    }
}

#[test]
fn a_stopped_or_damaged_unscored_run_goes_on_to_the_same_files() {
    let bench = Bench::new(&unscored());
    assert!(bench.invoke(&log(), 5).unwrap().is_stopped);
    assert!(!bench.invoke(&log(), usize::MAX).unwrap().is_stopped);
    assert_like_whole(bench.dir.path(), &bench.plan);
    let before = contents(&bench.path("images"));
    let name = before.keys().find(|name| name.ends_with(".exr")).unwrap();
    std::fs::remove_file(bench.path(&format!("images/{name}"))).unwrap();
    let (notes, renders) = bench.again().unwrap();
    assert_eq!((notes.len(), renders.len()), (1, 1), "{notes:?}");
    assert_like_whole(bench.dir.path(), &bench.plan);
}

#[test]
fn summary_and_report_say_once_that_nothing_is_scored() {
    let bench = Bench::finished(&unscored());
    let run = Finished::read(bench.dir.path()).unwrap();
    assert!(answers(&run, None).is_empty());
    let text = summary(bench.dir.path());
    let said = "The run has no scores, by reference = \"none\", so it answers no question; its \
                images are in images/.";
    assert_eq!(text.matches("no scores").count(), 1, "{text}");
    assert!(
        text.contains(said) && text.contains("No references."),
        "{text}"
    );
    assert_eq!(written(bench.dir.path()).record.headline(), said);
    let runs = [(run, Vec::new())];
    let page = write(
        &PageOptions::in_folder(bench.dir.path()),
        &PageRun::of_runs(&runs),
    )
    .unwrap();
    let text = std::fs::read_to_string(page.path).unwrap();
    assert!(text.contains("The run has no references to compare its images with"));
    assert!(!text.contains("cells failed"));
}

#[test]
fn an_unscored_plan_is_cheaper_and_splits_by_image() {
    let [scored, unscored] = [
        experiment("reference = { samples = 64, noise_share = 0 }\n"),
        unscored(),
    ]
    .map(|text| plan(&text));
    let seconds = |plan: &Plan| {
        let cells: Vec<_> = plan.cells.iter().collect();
        Forecast::new(plan, &cells, &[], []).ahead(0.0).seconds
    };
    assert!(seconds(&unscored) < seconds(&scored));
    assert_eq!((scored.groups().len(), unscored.groups().len()), (4, 8));
    assert!(unscored.cells.iter().all(|cell| cell.reference.is_none()));
    let ids = |plan: &Plan| plan.cells.iter().map(|cell| cell.id).collect::<Vec<_>>();
    assert!(ids(&scored).iter().all(|id| !ids(&unscored).contains(id)));
    // An image is in one part with both of its exposures.
    let parts = split(&unscored, 4);
    assert!(
        parts
            .iter()
            .all(|part| !part.cells.is_empty() && part.cells.len() % 2 == 0),
        "{parts:?}"
    );
    let bench = Bench::new(&self::unscored());
    for index in 1..=4 {
        shard(&bench, index);
    }
    assert_eq!(bench.images().len(), 8 + 16);
}

/// Does one part of four.
fn shard(bench: &Bench, index: u32) {
    let stop = std::sync::atomic::AtomicBool::new(false);
    let options = splitsum::run::RunOptions {
        shard: Some(format!("{index}/4").parse::<Shard>().unwrap()),
        ..super::runs::options(bench.dir.path(), &stop)
    };
    splitsum::run::run(
        &bench.plan,
        &mut super::runs::fakes(&log()),
        &options,
        &mut super::runs::Silent,
    )
    .unwrap();
}

#[test]
fn what_needs_scores_is_refused_in_one_message() {
    let fault = |text: &str| {
        let source = Source {
            check,
            ..Source::new(Path::new("x.toml"), text, &[])
        };
        Plan::from_source(&source, &Default::default())
            .expect_err("a fault")
            .to_string()
    };
    let asked = fault(&experiment("reference = \"none\"\nasks = [\"error\"]\n"));
    let expected = "x.toml:3:9: asks: \"error\" cannot be answered: it needs scores, and the \
                    experiment has reference = \"none\"";
    assert_eq!(asked, expected);
    let ladder = fault(&(unscored() + "[ladder]\n"));
    assert!(ladder.contains("[ladder] divides errors"), "{ladder}");
    assert_eq!(ladder.lines().count(), 1);
    let other = fault(&experiment("reference = \"nothing\"\n"));
    assert_eq!(
        other,
        "x.toml:2:13: reference: \"nothing\" is not \"none\", which renders cells without scores; or \
         write a table such as { samples = 4096 }"
    );
}

/// `method = "none"` in the section is a reference: the image without a specular term.
#[test]
fn a_reference_without_a_term_is_still_a_reference() {
    let plan = plan(&experiment("reference = { method = \"none\" }\n"));
    assert!(plan.config.is_scored);
    let bench = tempfile::tempdir().unwrap();
    invoke(&plan, bench.path(), &log(), 1).unwrap();
}
