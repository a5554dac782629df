//! Runs with failed cells: the comparison says what failed.

use crate::chromium::{self, Page};
use crate::fake::Log;
use crate::fixture::{assert_clean, page_of, report_of, run_of};
use serde_json::{Value, json};
use splitsum::pipeline::RenderRequest;
use splitsum::report::page::images::Choice;
use splitsum::table::csv::Table;
use std::path::{Path, PathBuf};

const AXES: &str = "environment = [\"builtin:constant\"]\nbrdf = [\"ggx\"]\nalpha = [0.05, 0.1, 0.25, 0.5, 1]\nmethod = [\"sampled\", \"split-sum\"]\nsamples = [1, 4, 16]";
const TIMING: &str = "[timing]\nwarmup = 1\nrounds = 3";

/// One count of one alpha fails; its case is the last to be completed.
fn is_broken(request: &RenderRequest) -> bool {
    let alpha = request.scene.materials.first().map_or(0.0, |material| material.alpha);
    request.shading.method.name == "sampled" && request.shading.samples == 1 && (alpha - 0.1).abs() < 1e-6
}

fn report(dir: &Path) -> PathBuf {
    let run = run_of(&dir.join("run"), AXES, TIMING, Log { broken: Some(is_broken), ..Log::default() });
    page_of(&run, Choice::Automatic)
}

/// The cells with a method and a sample count by alpha.
fn cell(report: &Path, [method, samples, alpha]: [&str; 3]) -> String {
    let table = Table::read(&report.with_file_name("errors.csv")).unwrap();
    let of = |row: &Vec<String>, name: &str| row[table.column(name).unwrap()].clone();
    let is_it =
        |row: &&Vec<String>| of(row, "method") == method && of(row, "samples") == samples && of(row, "alpha") == alpha;
    of(table.rows.iter().find(is_it).unwrap(), "cell")
}

fn hash(page: &mut Page) -> String {
    page.eval("location.hash").as_str().unwrap().to_owned()
}

#[test]
fn a_failed_cell_says_why_and_keys_lead_on() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let report = report(dir.path());
    let failed = cell(&report, ["sampled", "1", "0.1"]);
    page.resize(1440, 900, "light");
    page.go(&report, &format!("#compare?cell={failed}"));
    page.wait("document.querySelector('.viewer-stage').classList.contains('empty')");
    page.wait("document.querySelector('.caption').textContent !== ''");
    assert!(page.text(".caption").contains("the shader is broken"), "{}", page.text(".caption"));
    let label = page.eval("document.querySelector('.viewer-stage canvas').getAttribute('aria-label')");
    assert!(label.as_str().unwrap_or_default().contains("failed"), "{label}");
    page.key("2");
    page.wait("!document.querySelector('.viewer-stage').classList.contains('empty')");
    let chosen = page.eval("document.querySelector('.viewer-stage canvas').dataset.shown");
    assert_ne!(chosen, json!(failed));
    page.wait(&format!("location.hash.includes({chosen})"));
    assert!(!hash(&mut page).contains(&failed), "{}", hash(&mut page));
    // Back to it by an arrow and on to the next scene.
    page.go(&report, &format!("#compare?cell={failed}"));
    page.wait("document.querySelector('.viewer-stage').classList.contains('empty')");
    page.key("ArrowDown");
    page.wait("!document.querySelector('.viewer-stage').classList.contains('empty')");
    assert_clean(&page);
}

#[test]
fn the_comparison_keeps_its_wipe_its_pin_and_its_sign() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let report = report_of(dir.path(), AXES, "");
    let [first, next] = [["sampled", "4", "0.1"], ["sampled", "4", "0.25"]].map(|one| cell(&report, one));
    let ready = "document.querySelector('.viewer-stage canvas')?.dataset.ready !== undefined";
    page.resize(1440, 900, "light");
    page.go(&report, &format!("#compare?cell={first}&split=0.5&texel=11,13&mode=signed"));
    page.wait(ready);
    assert_eq!(page.text(".probe h2 span"), "texel (11, 13) · pinned");
    // The signed mode has signed values in its own colours.
    assert_eq!(page.text(".probe th:last-child"), "signed");
    let colors = |page: &mut Page| -> Vec<Value> {
        let all = page.eval("[...document.querySelectorAll('.probe tbody tr')].slice(1).map((r) => [Number(r.lastChild.dataset.value), r.querySelector('.chip').style.background.replaceAll(' ', '')])");
        all.as_array().unwrap().clone()
    };
    let signed = colors(&mut page);
    page.key("e");
    let relative = colors(&mut page);
    assert_eq!(page.text(".probe th:last-child"), "error");
    assert_eq!(signed.len(), 4);
    for (a, b) in signed.iter().zip(&relative) {
        let wanted = splitsum::table::colormap::SIGNED_ERROR.color(a[0].as_f64().unwrap());
        let shown: Vec<u8> =
            a[1].as_str().unwrap()[4..].trim_end_matches(')').split(',').map(|c| c.parse().unwrap()).collect();
        assert!(shown.iter().zip(wanted).all(|(s, w)| s.abs_diff(w) <= 2), "{a} {wanted:?}");
        assert_ne!(a[1], b[1]);
    }
    // The next scene has the same wipe, and the pin stays.
    page.key("ArrowDown");
    page.wait(&format!("location.hash.includes('cell={next}')"));
    assert!(["texel=11", "split=0.5"].iter().all(|part| hash(&mut page).contains(part)), "{}", hash(&mut page));
    page.eval("document.body.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowRight', shiftKey: true, bubbles: true }))");
    page.wait("location.hash.includes('texel=12%2C13')");
    // Capital letters are the same keys.
    page.key("B");
    page.wait("document.body.dataset.view === 'tables'");
    assert_clean(&page);
}
