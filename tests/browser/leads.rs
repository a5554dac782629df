//! The chart beside the answer is the one that the experiment asks for, and it can be read.

use crate::chromium::{self, Page};
use crate::fixture::assert_clean;
use crate::sections::{report_of, saved_csv, wait_for_figures};
use serde_json::json;
use splitsum::table::csv::Table;

const SCENE: &str = "environment = [\"builtin:constant\", \"builtin:sky\"]\nbrdf = [\"ggx\"]\nalpha = [0.1, 0.5]\n";
const BIASES: &str = "lod_bias = [0, -2, -1, -0.5, 0.5, 1, 1.5, 2, 2.5, 3]\npoint_set = [0, 1]\n";

/// Names of the figures on the first screen, in order.
fn figures(page: &mut Page) -> Vec<String> {
    page.wait("document.querySelectorAll('#lead-chart .figure .stage svg').length > 0");
    let names =
        page.eval("[...document.querySelectorAll('#view-answer .figure[data-figure]')].map((f) => f.dataset.figure)");
    names.as_array().unwrap().iter().map(|name| name.as_str().unwrap().to_owned()).collect()
}

#[test]
fn times_lead_with_passes_tables_and_payback() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let axes = format!("{SCENE}method = [\"sampled\", \"split-sum\"]\nsamples = [16]");
    let report = report_of(dir.path(), &axes, "[timing]\nwarmup = 1\nrounds = 9");
    page.resize(1440, 900, "light");
    page.go(&report, "");
    assert_eq!(figures(&mut page)[..2], ["passes-frame", "passes-precompute"]);
    // The frames after which the tables are paid are those of the run's own table.
    let truth = Table::read(&report.with_file_name("timing_ratios.csv")).unwrap();
    let column = truth.columns.iter().position(|name| name.contains("payback")).unwrap();
    let wanted: Vec<&str> = truth.rows.iter().map(|row| row[column].as_str()).collect();
    let shown = page.eval("[...document.querySelectorAll('#lead-chart .payback')].map((td) => td.textContent)");
    let shown: Vec<&str> = shown.as_array().unwrap().iter().map(|text| text.as_str().unwrap()).collect();
    assert!(!shown.is_empty() && shown.len() == wanted.len(), "{shown:?} {wanted:?}");
    assert!(shown.iter().zip(&wanted).all(|(shown, wanted)| shown.starts_with(wanted)), "{shown:?} {wanted:?}");
    // Two times that a reader divides are not the ratio beside them, which says so.
    assert!(page.text(".payback-table .note").contains("not the quotient of two medians"));
    assert_clean(&page);
}

#[test]
fn a_varied_parameter_leads_with_its_effects() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let axes = format!("{SCENE}method = [\"sampled\", \"sampled-unfiltered\"]\nsamples = [4, 16]\n{BIASES}");
    let report = report_of(dir.path(), &axes, "");
    page.resize(1440, 900, "light");
    page.go(&report, "");
    // The method comes first, as in the sentence; the parameter stands beside it.
    assert_eq!(figures(&mut page)[..2], ["effects-method", "effects-lod_bias"]);
    assert_eq!(page.eval("document.querySelectorAll('#lead-chart .figure').length"), json!(2));
    let path = dir.path().join("saved.csv");
    std::fs::write(&path, saved_csv(&mut page, "effects-lod_bias")).unwrap();
    let truth = Table::read(&report.with_file_name("answers").join("effects.csv")).unwrap();
    let key = |table: &Table, row: &Vec<String>| {
        ["value", "method", "alpha", "error_ratio", "pairs"].map(|name| {
            let text = row[table.column(name).unwrap()].clone();
            text.parse::<f64>().map_or(text, |x| format!("{x:.9e}"))
        })
    };
    let saved = Table::read(&path).unwrap();
    let axis = truth.column("axis").unwrap();
    let mut wanted: Vec<_> =
        truth.rows.iter().filter(|row| row[axis] == "lod_bias").map(|row| key(&truth, row)).collect();
    let mut shown: Vec<_> = saved.rows.iter().map(|row| key(&saved, row)).collect();
    wanted.sort();
    shown.sort();
    assert_eq!(shown, wanted);
    // Two methods over nine values beside the base, each with its interval.
    let drawn = page.eval(
        "(() => { const svg = document.querySelector('[data-figure=\"effects-lod_bias\"] .stage svg'); \
         return [svg.querySelectorAll('.dot').length, svg.querySelectorAll('g > line[opacity]').length]; })()",
    );
    assert_eq!(drawn, json!([18, 18]));
    // The images beside it differ in the bias alone.
    let cells = page.eval("[...document.querySelectorAll('[data-shown]')].map((e) => e.dataset.shown)");
    let errors = Table::read(&report.with_file_name("errors.csv")).unwrap();
    let of = |cell: &str, name: &str| {
        let row = errors.rows.iter().find(|row| row[errors.column("cell").unwrap()] == cell).unwrap();
        row[errors.column(name).unwrap()].clone()
    };
    let cells: Vec<&str> = cells.as_array().unwrap().iter().map(|cell| cell.as_str().unwrap()).collect();
    assert!(cells.len() > 1);
    for name in ["method", "samples", "point_set", "alpha", "environment"] {
        assert!(cells.iter().all(|cell| of(cell, name) == of(cells[0], name)), "{name} differs");
    }
    assert!(cells.iter().any(|cell| of(cell, "lod_bias") != of(cells[0], "lod_bias")));
    // No more lines over n.v than can be told apart; the rest by a choice.
    page.go(&report, "#plots");
    wait_for_figures(&mut page);
    let lines = page.eval("document.querySelectorAll('[data-figure^=\"n-dot-v\"] .legend li').length");
    assert!((2..=7).contains(&lines.as_u64().unwrap()), "{lines}");
    assert!(
        page.text("[data-figure^=\"n-dot-v\"] .note").contains("7 of 22 ways"),
        "{}",
        page.text("[data-figure^=\"n-dot-v\"] .note")
    );
    assert!(page.text("#view-plots .controls").contains("Profile lines"));
    assert_clean(&page);
}

#[test]
fn exposure_and_contrast_lead_with_a_map_for_each_method() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let axes = format!(
        "{SCENE}method = [\"sampled\", \"split-sum\"]\nsamples = [1, 4]\nexposure = [0.1, 1, 10]\ncontrast = [1, 2]"
    );
    let report = report_of(dir.path(), &axes, "");
    page.resize(1440, 900, "light");
    page.go(&report, "");
    assert_eq!(figures(&mut page)[0], "visibility");
    let drawn = page.eval(
        "(() => { const svg = document.querySelector('[data-figure=\"visibility\"] .stage svg'); \
         return [[...svg.querySelectorAll('.panel-title')].map((t) => t.textContent), svg.querySelectorAll('.cell').length]; })()",
    );
    assert_eq!(drawn, json!([["sampled 1", "sampled 4", "split-sum"], 18]));
    // Settings that are no grid: one map a method, its sample counts down.
    let dir = tempfile::tempdir().unwrap();
    let report =
        report_of(dir.path(), &axes, "[[exclude]]\nexposure = [0.1, 10]\ncontrast = 2\nwhy = \"one at a time\"");
    page.go(&report, "");
    figures(&mut page);
    let titles = page
        .eval("[...document.querySelectorAll('[data-figure=\"visibility\"] .panel-title')].map((t) => t.textContent)");
    assert_eq!(titles, json!(["sampled", "split-sum"]));
    assert_clean(&page);
}

#[test]
fn every_mark_is_seen_and_flat_lines_have_marks() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let axes = "environment = [\"builtin:constant\"]\nbrdf = [\"ggx\"]\nalpha = [0.1, 0.2, 0.3, 0.5, 1]\nmethod = [\"sampled\", \"split-sum\"]\nsamples = [1, 4, 16]";
    let report = report_of(dir.path(), axes, "[timing]\nwarmup = 1\nrounds = 9");
    page.resize(1440, 900, "light");
    page.go(&report, "#plots");
    wait_for_figures(&mut page);
    let figure = "document.querySelector('[data-figure^=\"convergence\"] .stage svg')";
    // The fifth shape is a cross, which is all stroke.
    let crosses = page.eval(&format!(
        "(() => {{ const paper = getComputedStyle(document.body).backgroundColor; \
         return [...{figure}.querySelectorAll('path.dot')].map((p) => getComputedStyle(p).stroke !== paper && parseFloat(getComputedStyle(p).strokeWidth) >= 2); }})()"
    ));
    // Three counts and both ends of the flat line.
    assert_eq!(crosses, json!(vec![true; 5]));
    // Three counts and two ends in five cases.
    assert_eq!(page.eval(&format!("{figure}.querySelectorAll('.dot.open').length")), json!(25));
    let labels = page.eval(&format!("{figure}.querySelectorAll('.tick[text-anchor=end]').length"));
    assert!(labels.as_u64().unwrap() >= 3, "{labels}");
    // The Pareto front is marked, not drawn as a line that nothing was measured on.
    let front = page
        .eval("document.querySelectorAll('[data-figure^=\"time-error\"] .stage svg path[stroke]:not(.dot)').length");
    assert_eq!(front, json!(0));
    assert_clean(&page);
}

#[test]
fn a_phone_shows_the_chart_on_its_first_screen() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let axes = format!("{SCENE}method = [\"sampled\", \"split-sum\"]\nsamples = [1, 4, 16]");
    let report = report_of(dir.path(), &axes, "[timing]\nwarmup = 1\nrounds = 9");
    page.resize(390, 844, "light");
    page.go(&report, "");
    figures(&mut page);
    let top = page.eval("document.querySelector('#lead-chart .stage svg').getBoundingClientRect().top");
    assert!(top.as_f64().unwrap() < 640.0, "{top}");
    let mind = page.eval("document.querySelector('.mind-first').getBoundingClientRect().bottom").as_f64().unwrap();
    assert!(mind > 0.0 && mind < 640.0 && page.text(".mind-first").contains("CPU driver"), "{mind}");
    // A menu that goes on beyond an edge says so.
    let menu = "(() => { const nav = document.getElementById('pages'); return [nav.scrollWidth > nav.clientWidth + 1, nav.dataset.more]; })()";
    page.resize(320, 800, "light");
    page.wait("document.getElementById('pages').dataset.more === 'right'");
    assert_eq!(page.eval(menu), json!([true, "right"]));
    page.eval("document.getElementById('pages').scrollLeft = 1e4");
    page.wait("document.getElementById('pages').dataset.more === 'left'");
    page.resize(1440, 900, "light");
    page.wait("document.getElementById('pages').dataset.more === ''");
    assert_clean(&page);
}
