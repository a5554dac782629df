//! Runs with failed cells: what is pooled stands for the same scenes, orders are those of the values, and the comparison says what failed.

use crate::chromium::{self, Page};
use crate::fake::Log;
use crate::fixture::assert_clean;
use crate::joined::texts;
use crate::sections::{report_of, run_of, saved_csv, wait_for_figures};
use serde_json::{Value, json};
use splitsum::pipeline::RenderRequest;
use splitsum::study::report::{ReportOptions, write};
use splitsum::table::csv::Table;
use std::path::{Path, PathBuf};

const AXES: &str = "environment = [\"builtin:constant\"]\nbrdf = [\"ggx\"]\nalpha = [0.05, 0.1, 0.25, 0.5, 1]\nmethod = [\"sampled\", \"split-sum\"]\nsamples = [1, 4, 16]";
const TIMING: &str = "[timing]\nwarmup = 1\nrounds = 3";

/// One count of one alpha fails; its case is the last to be completed.
fn is_broken(request: &RenderRequest) -> bool {
    let alpha = request.scene.materials.first().map_or(0.0, |material| material.alpha);
    request.method.name == "sampled" && request.samples == 1 && (alpha - 0.1).abs() < 1e-6
}

fn report(dir: &Path) -> PathBuf {
    let run = run_of(&dir.join("run"), AXES, TIMING, Log { broken: Some(is_broken), ..Log::default() });
    write(&ReportOptions::of_run(&run)).unwrap().path
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
fn medians_over_cases_are_of_the_same_cases() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let report = report(dir.path());
    page.resize(1440, 900, "light");
    page.go(&report, "#plots?all=1");
    wait_for_figures(&mut page);
    let saved = saved_csv(&mut page, "time-error-all");
    let table: Vec<Vec<&str>> = saved.lines().map(|line| line.split(',').collect()).collect();
    let column = table[0].iter().position(|name| *name == "cells").unwrap();
    let cells: Vec<&str> = table[1..].iter().map(|row| row[column]).collect();
    assert_eq!(cells, ["4"; 4], "{saved}");
    assert!(page.text("[data-figure=\"time-error-all\"] .note").contains("4 of 5 scenes"));
    page.go(&report, "");
    wait_for_figures(&mut page);
    let note = page.text("[data-figure=\"break-even-curves\"] .note");
    assert!(note.contains("4 of 5 cases that have every count"), "{note}");
    // The case of the failed cell came late; its value has its place in the order all the same.
    let legend = texts(&mut page, "[data-figure=\"break-even-curves\"] .legend li");
    assert_eq!(legend, ["α 0.05", "α 0.1", "α 0.25", "α 0.5", "α 1", "median"]);
    // Helpers on bare rows: without a common place all rows are left, and said to be.
    let shared = page.eval(
        "import('report/cases').then(({ ordered, sharedRows, sharedText }) => { const rows = [['a', 1], ['a', 2], ['b', 2]], \
         of = (own) => sharedRows(own, ([name]) => name, ([, place]) => place), common = of(rows), apart = of([['a', 1], ['b', 2]]); \
         return [ordered(['0.5', '1', '0.1']), ordered(['b', 'a']), common.own.length, sharedText(common, 'scenes'), apart.own.length, apart.shared, sharedText(apart, 'scenes').slice(0, 9)]; })",
    );
    let wanted = json!([
        ["0.1", "0.5", "1"],
        ["b", "a"],
        2,
        " Over 1 of 2 scenes: those that have a result for all that is shown.",
        2,
        0,
        " No scene"
    ]);
    assert_eq!(shared, wanted);
    assert_clean(&page);
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
fn the_comparison_keeps_its_partner_its_pin_and_its_sign() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let report = report_of(dir.path(), AXES, "");
    let [left, right, next] =
        [["sampled", "4", "0.1"], ["split-sum", "", "0.1"], ["split-sum", "", "0.25"]].map(|one| cell(&report, one));
    let ready = "document.querySelector('.viewer-stage canvas')?.dataset.ready !== undefined";
    page.resize(1440, 900, "light");
    page.go(&report, &format!("#compare?cell={left}&with={right}&split=0.5&texel=11,13&mode=signed"));
    page.wait(ready);
    assert_eq!(page.text(".probe h2 span"), "texel (11, 13) · pinned");
    // The signed mode has signed values in its own colours.
    assert_eq!(page.text(".probe th:last-child"), "signed error");
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
    // The next scene has the same partner, and the pin stays.
    page.key("ArrowDown");
    page.wait(&format!("location.hash.includes('with={next}')"));
    assert!(hash(&mut page).contains("texel=11"), "{}", hash(&mut page));
    page.eval("document.body.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowRight', shiftKey: true, bubbles: true }))");
    page.wait("location.hash.includes('texel=12%2C13')");
    // Capital letters are the same keys.
    page.key("P");
    page.wait("document.body.dataset.view === 'plots'");
    assert_clean(&page);
}

#[test]
fn one_count_makes_no_convergence() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let axes = AXES.replace("samples = [1, 4, 16]", "samples = [4]");
    let report = report_of(dir.path(), &axes, TIMING);
    page.go(&report, "#plots");
    wait_for_figures(&mut page);
    assert_eq!(page.eval("document.querySelectorAll('[data-figure^=\"convergence\"]').length"), json!(0));
    assert_clean(&page);
}

#[test]
fn a_comparison_of_two_shows_its_pooled_effect_and_sizes_keep_their_names() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let axes = "environment = [\"builtin:constant\"]\nbrdf = [\"ggx\"]\nalpha = [0.05, 0.1, 0.25, 0.5]\nmethod = [\"sampled\", \"sampled-unfiltered\"]\nsamples = [4]";
    let report = report_of(dir.path(), axes, "");
    page.resize(1440, 900, "light");
    page.go(&report, "#plots");
    wait_for_figures(&mut page);
    let ticks = texts(&mut page, "[data-figure=\"effects-method\"] .tick");
    assert_eq!(ticks[..5], ["all", "0.05", "0.1", "0.25", "0.5"], "{ticks:?}");
    let whole = page.eval("import('report/data').then(({ model }) => model.runs[0].effects.filter((e) => e.axis === 'method' && e.alpha === null).length)");
    let dots = page.eval("document.querySelectorAll('[data-figure=\"effects-method\"] .dot').length");
    assert_eq!(dots.as_u64().unwrap(), 4 + whole.as_u64().unwrap());
    // On a phone nine sizes stand on two lines, each of them.
    let kept = page.eval(
        "import('report/chart').then(({ xy }) => { const sizes = Array.from({ length: 9 }, (_, i) => `${4 << i}x${2 << i}`); \
         const svg = xy({ x: { domain: [-0.4, 8.4], ticks: sizes.map((_, i) => i), format: (i) => sizes[i], staggers: true, label: 'size' }, y: { label: '', domain: [0, 1] }, marks: [] })(354, 260, document.createElement('div')); \
         const own = [...svg.querySelectorAll('.tick')].filter((t) => sizes.includes(t.textContent)); return [own.length, new Set(own.map((t) => t.getAttribute('y'))).size]; })",
    );
    assert_eq!(kept, json!([9, 2]));
    assert_clean(&page);
}
