//! Joined runs: each with its own answers and its own warning, and what tells them apart.

use crate::chromium::{self, Page};
use crate::fake::Log;
use crate::fixture::{assert_clean, page_of, report_of, run_of, run_of_text, write_page};
use serde_json::json;
use splitsum::report::page::PageOptions;
use splitsum::report::page::images::Choice;
use std::path::{Path, PathBuf};

const ALL: &str = "environment = [\"builtin:constant\"]\nbrdf = [\"ggx\"]\nalpha = [0.1, 0.5]\nmethod = [\"sampled\", \"split-sum\"]\nsamples = [1, 4, 16]";
const FEW: &str = "environment = [\"builtin:constant\"]\nbrdf = [\"ggx\"]\nalpha = [0.1, 0.5]\nmethod = [\"sampled\", \"split-sum\"]\nsamples = [1, 4]";

/// Three finished runs in a folder: one, the same again, and one with fewer samples on another device. Their joined report comes last.
pub fn joined(dir: &Path) -> ([PathBuf; 3], PathBuf) {
    let runs = [
        run_of(&dir.join("one"), ALL, "", Log::default()),
        run_of(&dir.join("again"), ALL, "", Log::default()),
        run_of(&dir.join("few"), FEW, "", Log { device: Some("another device"), ..Log::default() }),
    ];
    let options = PageOptions { out: dir.join("joined.html"), ..PageOptions::in_folder(&runs[0]) };
    let report = write_page(&runs, &options);
    (runs, report)
}

pub fn texts(page: &mut Page, selector: &str) -> Vec<String> {
    let all =
        page.eval(&format!("[...document.querySelectorAll({})].map((e) => e.textContent.trim())", json!(selector)));
    all.as_array().unwrap().iter().map(|text| text.as_str().unwrap().to_owned()).collect()
}

/// The words of the marks of figures.
fn tips(page: &mut Page, figures: &str) -> serde_json::Value {
    page.eval(&format!("[...document.querySelectorAll('{figures} .mark')].map((e) => e.dataset.tip)"))
}

#[test]
fn each_run_has_the_answers_that_it_has_alone() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let (runs, report) = joined(dir.path());
    let mut alone = Vec::new();
    for run in &runs {
        page.go(&page_of(run, Choice::Automatic), "");
        alone.push((page.text(".first .sentence"), tips(&mut page, ".figure-box .desk")));
    }
    page.resize(1440, 900, "light");
    page.go(&report, "");
    let sentences = texts(&mut page, ".card .sentence");
    assert_eq!(sentences, alone.iter().map(|run| run.0.clone()).collect::<Vec<_>>());
    assert!(sentences[0] != sentences[2], "{sentences:?}");
    for (i, (sentence, marks)) in alone.iter().enumerate() {
        let block = format!("#run-{}", i + 1);
        assert_eq!(&texts(&mut page, &format!("{block} .answer .sentence"))[0], sentence);
        assert_eq!(&tips(&mut page, &format!("{block} .figure-box .desk")), marks);
    }
    // The second one is said to be no further evidence.
    let repeats = texts(&mut page, ".joined > .warning");
    assert_eq!(repeats.len(), 1, "{repeats:?}");
    assert!(repeats[0].contains("again repeats one") && repeats[0].contains("no further evidence"), "{repeats:?}");
    // What tells them apart stands on the first screen.
    assert_eq!(texts(&mut page, "#apart tbody th"), ["device"]);
    assert_eq!(page.text("#same"), "The same in all: commit, question.");
    let bottom = page.eval("document.querySelector('#apart').getBoundingClientRect().bottom").as_f64().unwrap();
    assert!(bottom < 900.0, "{bottom}");
    // Anchors name the question and, from the second run on, the run.
    page.go(&report, "#break-even-3");
    let top = page.eval("document.querySelector('[id=break-even-3]').getBoundingClientRect().top").as_f64().unwrap();
    assert!((0.0..450.0).contains(&top), "{top}");
    assert_clean(&page);
}

#[test]
fn images_of_equal_cells_of_two_runs_are_told_apart() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let (_, report) = joined(dir.path());
    page.resize(1440, 900, "light");
    // A mark leads to the images of its own run.
    page.go(&report, "");
    page.eval("document.querySelector('#run-2 .desk .mark[data-cell]').dispatchEvent(new MouseEvent('click', { bubbles: true }))");
    page.wait("location.hash.includes('run=1')");
    page.wait("document.querySelector('.viewer-stage canvas')?.dataset.ready !== undefined");
    let pressed = "[...document.querySelectorAll('.variant[aria-pressed=true]')].map((b) => b.dataset.run)";
    assert_eq!(page.eval(pressed), json!(["1"]));
    assert_eq!(page.eval("document.querySelectorAll('.probe tr.current').length"), json!(1));
    assert!(texts(&mut page, ".badge")[0].starts_with("again"));
    page.eval("document.querySelector('.variant[data-run=\"0\"]').click()");
    page.wait("document.querySelector('.badge').textContent.startsWith('one')");
    assert_clean(&page);
}
