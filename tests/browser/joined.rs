//! Joined runs: each with its own answer, its own charts and its own warning, and what tells them apart.

use crate::chromium::{self, Page};
use crate::fake::Log;
use crate::fixture::assert_clean;
use crate::sections::{self, report_of, run_of};
use serde_json::json;
use splitsum::study::report::{ReportOptions, write};
use std::path::{Path, PathBuf};

const ALL: &str = "environment = [\"builtin:constant\"]\nbrdf = [\"ggx\"]\nalpha = [0.1, 0.5]\nmethod = [\"sampled\", \"split-sum\"]\nsamples = [1, 4, 16]";
const FEW: &str = "environment = [\"builtin:constant\"]\nbrdf = [\"ggx\"]\nalpha = [0.1, 0.5]\nmethod = [\"sampled\", \"split-sum\"]\nsamples = [1, 4]";
const TIMING: &str = "[timing]\nwarmup = 1\nrounds = 9";

/// Three finished runs in a folder: one, the same again, and one with fewer samples on another device. Their joined report comes last.
pub fn joined(dir: &Path) -> ([PathBuf; 3], PathBuf) {
    let runs = [
        run_of(&dir.join("one"), ALL, TIMING, Log::default()),
        run_of(&dir.join("again"), ALL, TIMING, Log::default()),
        run_of(&dir.join("few"), FEW, TIMING, Log { device: Some("another device"), ..Log::default() }),
    ];
    let options =
        ReportOptions { dirs: runs.to_vec(), out: Some(dir.join("joined.html")), ..ReportOptions::of_run(&runs[0]) };
    (runs, write(&options).unwrap().path)
}

pub fn texts(page: &mut Page, selector: &str) -> Vec<String> {
    let all =
        page.eval(&format!("[...document.querySelectorAll({})].map((e) => e.textContent.trim())", json!(selector)));
    all.as_array().unwrap().iter().map(|text| text.as_str().unwrap().to_owned()).collect()
}

#[test]
fn each_run_has_the_answer_that_it_has_alone() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let (runs, report) = joined(dir.path());
    let alone: Vec<[String; 2]> = runs
        .iter()
        .map(|run| {
            page.go(&write(&ReportOptions::of_run(run)).unwrap().path, "");
            [page.text(".headline-number strong"), page.text(".sentence")]
        })
        .collect();
    page.resize(1440, 900, "light");
    page.go(&report, "");
    let (numbers, sentences) = (texts(&mut page, ".headline-number strong"), texts(&mut page, ".sentence"));
    assert_eq!(numbers, alone.iter().map(|run| run[0].clone()).collect::<Vec<_>>());
    assert_eq!(sentences, alone.iter().map(|run| run[1].clone()).collect::<Vec<_>>());
    assert_eq!(numbers, ["16", "16", "> 4"]);
    // The second one is said to be no further evidence; times are never equal to the last digit.
    let repeats = texts(&mut page, ".joined > .warning");
    assert_eq!(repeats.len(), 1, "{repeats:?}");
    assert!(repeats[0].contains("identical to") && repeats[0].contains("no further evidence"), "{repeats:?}");
    // The warning is that of each device.
    let warnings = texts(&mut page, ".told .warning");
    assert!(
        warnings[0].contains("times of fake come") && warnings[2].contains("times of another device come"),
        "{warnings:?}"
    );
    // What differs stands on the first screen or just below it, by name.
    let told: Vec<String> = texts(&mut page, "#apart tbody th");
    for what in ["device", "plan", "cells"] {
        assert!(told.iter().any(|name| name == what), "{what} is not among {told:?}");
    }
    let top = page.eval("document.querySelector('#apart').getBoundingClientRect().top").as_f64().unwrap();
    assert!(top < 1100.0, "{top}");
    let equal = page.text(".apart summary");
    assert!(["device type", "Vulkan", "device memory", "command"].iter().all(|what| equal.contains(what)), "{equal}");
    assert_clean(&page);
}

#[test]
fn no_chart_joins_runs() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let (_, report) = joined(dir.path());
    page.resize(1440, 900, "light");
    page.go(&report, "");
    page.wait("document.querySelectorAll('#view-answer .figure .stage svg').length >= 9");
    // A panel of lines for each run, with its own counts alone on the axis that all of them have.
    for (run, counts) in [(0, 3), (1, 3), (2, 2)] {
        let own = format!("[data-figure=\"break-even-curves-run-{}\"] .stage svg", run + 1);
        let ticks = texts(&mut page, &format!("{own} .tick[text-anchor=middle]"));
        assert_eq!(ticks.last().unwrap(), "16", "{ticks:?}");
        let places = page.eval(&format!("new Set([...document.querySelectorAll({} + ' circle.dot[r=\\'2.6\\']')].map((dot) => dot.getAttribute('cx'))).size", json!(own)));
        assert_eq!(places, json!(counts), "run {run}");
        // A line a case and the median.
        let lines =
            page.eval(&format!("document.querySelectorAll({} + ' g > path[stroke]:not(.dot)').length", json!(own)));
        assert_eq!(lines, json!(3));
        let cells = texts(&mut page, &format!("[data-figure=\"break-even-run-{}\"] .cell text", run + 1));
        assert_eq!(cells, [if run < 2 { "16" } else { "> 4" }; 2], "run {run}");
    }
    let smallest = page.eval(
        "Math.min(...[...document.querySelectorAll('#view-answer .cell text')].map((t) => parseFloat(getComputedStyle(t).fontSize)))",
    );
    assert!(smallest.as_f64().unwrap() >= 9.0, "{smallest}");
    // Plots are those of one run at a time.
    page.go(&report, "#plots?run=2");
    sections::wait_for_figures(&mut page);
    let names = page.eval("[...document.querySelectorAll('#view-plots .figure')].map((f) => f.dataset.figure)");
    assert!(names.as_array().unwrap().iter().all(|name| name.as_str().unwrap().ends_with("-run-3")), "{names}");
    let passes = texts(&mut page, "[data-figure=\"passes-frame-run-3\"] .tick[text-anchor=end]");
    assert_eq!(passes.len(), 3, "{passes:?}");
    assert_clean(&page);
}

#[test]
fn images_of_equal_cells_of_two_runs_are_told_apart() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let (_, report) = joined(dir.path());
    page.resize(1440, 900, "light");
    page.go(&report, "#compare");
    page.wait("document.querySelector('.viewer-stage canvas')?.dataset.ready !== undefined");
    let pressed = "[...document.querySelectorAll('.variant[aria-pressed=true]')].map((b) => b.dataset.run)";
    assert_eq!(page.eval(pressed), json!(["0"]));
    // The same cell of the second run, beside that of the first.
    page.eval("(() => { const cell = document.querySelector('.variant[aria-pressed=true]').dataset.cell; \
               [...document.querySelectorAll('.variant')].find((b) => b.dataset.cell === cell && b.dataset.run === '1').click(); })()");
    page.wait("location.hash.includes('run=1')");
    assert_eq!(page.eval(pressed), json!(["1"]));
    assert_eq!(page.eval("document.querySelectorAll('.probe tr.current').length"), json!(1));
    page.eval("(() => { const box = document.querySelector('[aria-label=\"Split with\"]'), cell = document.querySelector('.variant[aria-pressed=true]').dataset.cell; \
               box.value = cell; box.dispatchEvent(new Event('change')); })()");
    page.wait("!document.querySelector('.badge.right').hidden");
    let badges = texts(&mut page, ".badge");
    assert!(badges[0].starts_with("again") && badges[1].starts_with("one"), "{badges:?}");
    assert_clean(&page);
}

#[test]
fn what_is_never_reached_has_a_mark_of_its_own() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let report = report_of(dir.path(), FEW, TIMING);
    page.resize(1200, 900, "light");
    page.go(&report, "#plots");
    sections::wait_for_figures(&mut page);
    let figure = "[data-figure^=\"equal-time-intervals\"]";
    assert!(page.text(&format!("{figure} .legend")).contains("never up to 4"));
    // An arrow for each of the two cases, and no dot that would claim a count.
    let marks = page.eval(&format!(
        "(() => {{ const svg = document.querySelector('{figure} .stage svg'); return [svg.querySelectorAll('path.dot').length >= 2, svg.querySelectorAll('circle.dot').length]; }})()"
    ));
    assert_eq!(marks, json!([true, 0]));
    assert_clean(&page);
}

#[test]
fn the_heading_names_what_every_run_asks() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let runs: Vec<PathBuf> = ["Which?", "How much?", "Why?", "Which?"]
        .iter()
        .enumerate()
        .map(|(i, question)| {
            let text = format!("name = \"asks\"\nquestion = \"{question}\"\nsize = [8, 8]\n[axes]\n{FEW}\n");
            sections::run_of_text(&dir.path().join(format!("run-{i}")), &text, Log::default())
        })
        .collect();
    for (chosen, wanted) in
        [(&[0, 3][..], "Which?"), (&[0, 1], "Which? · How much?"), (&[0, 1, 2], "3 runs, 3 questions")]
    {
        let dirs: Vec<PathBuf> = chosen.iter().map(|&i| runs[i].clone()).collect();
        let options = ReportOptions { out: Some(dir.path().join("joined.html")), ..ReportOptions::of_run(&dirs[0]) };
        page.go(&write(&ReportOptions { dirs: dirs.clone(), ..options }).unwrap().path, "");
        assert_eq!(page.text("#question"), wanted);
        let told = texts(&mut page, ".told .note");
        assert_eq!(told.len(), if wanted == "Which?" { 0 } else { dirs.len() }, "{told:?}");
    }
    assert_clean(&page);
}
