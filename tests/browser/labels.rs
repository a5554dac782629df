//! Words of charts: none covers another, leaves its picture, or is crossed by a line that a reader looks for.

use crate::chromium::{self, Page};
use crate::fake::Log;
use crate::fixture::assert_clean;
use crate::sections::{report_of, run_of_text, wait_for_figures};
use serde_json::json;
use splitsum::study::report::{ReportOptions, write};
use std::path::{Path, PathBuf};

const SCENE: &str = "environment = [\"builtin:constant\"]\nbrdf = [\"ggx\"]\nalpha = [0.1, 0.5]\n";

/// What is wrong with the words of every chart of the view: those that leave their picture, cover each other by more than two pixels, or lie
/// on a whisker or rule. Letters of maps stand on their cells.
const FAULTS: &str = "(() => { const faults = []; \
    for (const svg of document.querySelectorAll('.view:not([hidden]) .figure .stage svg')) { \
      const name = svg.closest('.figure').dataset.figure, frame = svg.getBoundingClientRect(), unit = frame.width / svg.viewBox.baseVal.width; \
      const words = [...svg.querySelectorAll('text')].filter((t) => t.textContent && !t.closest('.cell')).map((t) => ({ text: t.textContent, box: t.getBoundingClientRect() })); \
      const lines = [...svg.querySelectorAll('g > line')].map((line) => line.getBoundingClientRect()); \
      const meet = (a, b, by) => Math.min(a.right, b.right) - Math.max(a.left, b.left) > by && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > by; \
      words.forEach(({ text, box }, i) => { \
        if (box.left < frame.left - 1 || box.right > frame.right + 1 || box.top < frame.top - 1 || box.bottom > frame.bottom + 1) faults.push(`${name}: ${text} leaves the picture`); \
        for (const other of words.slice(i + 1)) if (meet(box, other.box, 2 * unit)) faults.push(`${name}: ${text} covers ${other.text}`); \
        const heart = { left: box.left + unit, right: box.right - unit, top: box.top + 3.5 * unit, bottom: box.bottom - 3.5 * unit }; \
        if (lines.some((line) => meet(heart, { left: line.left - 0.1, right: line.right + 0.1, top: line.top - 0.1, bottom: line.bottom + 0.1 }, 0))) faults.push(`${name}: ${text} is crossed`); \
      }); \
    } \
    return faults; })()";

/// The report of a white furnace.
pub fn furnace(dir: &Path) -> PathBuf {
    let text = "name = \"furnace\"\nsize = [24, 24]\nreference = { method = \"none\", samples = 64, terms = \"all\" }\n[axes]\n\
        environment = [\"builtin:constant\"]\nbrdf = [\"ggx\", \"phong\"]\nmasking = [\"separable\", \"correlated\"]\nalpha = [0.1, 0.25, 0.5]\n\
        method = [\"reference\"]\nsamples = [64]\ndiffuse = [\"none\"]\nf0 = [1]\nalbedo = [1]\nmetallic = [0]\n";
    write(&ReportOptions::of_run(&run_of_text(&dir.join("furnace"), text, Log::default()))).unwrap().path
}

fn assert_no_faults(page: &mut Page, report: &Path) {
    for (width, height) in [(390, 844), (1440, 900), (3840, 2160)] {
        page.resize(width, height, "light");
        for view in ["", "#plots"] {
            page.go(report, view);
            wait_for_figures(page);
            assert_eq!(page.eval(FAULTS), json!([]), "{} {view} at {width}", report.display());
        }
    }
    assert_clean(page);
}

#[test]
fn words_of_charts_cover_nothing() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let lights =
        "environment = [\"builtin:constant\", \"builtin:sky\", \"builtin:studio\"]\nbrdf = [\"ggx\"]\nalpha = [0.1]\n";
    let samples = "method = [\"sampled\", \"split-sum\"]\nsamples = [1, 4, 16]";
    for (name, axes, rest) in [
        ("pairs", format!("{SCENE}{samples}"), "[timing]\nwarmup = 1\nrounds = 9"),
        ("few", format!("{lights}method = [\"sampled\", \"sampled-unfiltered\"]\nsamples = [4]"), ""),
        (
            "biases",
            format!(
                "{SCENE}method = [\"sampled\"]\nsamples = [4, 16]\nlod_bias = [0, -1, 1, \"materialx\", \"godot\", 2.5]"
            ),
            "",
        ),
        (
            "sizes",
            format!(
                "{SCENE}method = [\"split-sum\"]\nprefilter_level_count = [2]\nprefilter_size = [[64, 32], [32, 16], [128, 64]]"
            ),
            "",
        ),
    ] {
        std::fs::create_dir(dir.path().join(name)).unwrap();
        let report = report_of(&dir.path().join(name), &axes, rest);
        assert_no_faults(&mut page, &report);
    }
    assert_no_faults(&mut page, &furnace(dir.path()));
    // The measure finds what it is to find.
    page.eval("document.querySelector('.figure .stage svg text').setAttribute('x', '-500')");
    assert!(page.eval(FAULTS)[0].as_str().unwrap().ends_with("leaves the picture"));
}

#[test]
fn values_of_engines_have_their_names() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let axes = format!("{SCENE}method = [\"sampled\"]\nsamples = [4, 16]\nlod_bias = [0, 1, \"materialx\", 2.5]");
    let report = report_of(dir.path(), &axes, "");
    page.resize(1440, 900, "light");
    page.go(&report, "");
    wait_for_figures(&mut page);
    let figure = "[data-figure=\"effects-lod_bias\"]";
    let note = page.text(&format!("{figure} .note"));
    assert!(note.contains("filament 1, materialx 1.151."), "{note}");
    let upright = page
        .eval(&format!("[...document.querySelectorAll('{figure} text[transform].mark')].map((t) => t.textContent)"));
    assert_eq!(upright, json!(["filament", "materialx"]));
    let saved = crate::sections::saved_csv(&mut page, "effects-lod_bias");
    assert!(saved.starts_with("axis,value,preset,base") && saved.contains("lod_bias,1,filament,0,"), "{saved}");
    assert_clean(&page);
}

#[test]
fn a_furnace_leads_with_its_energy_by_angle() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let report = furnace(dir.path());
    page.resize(1440, 900, "light");
    page.go(&report, "");
    wait_for_figures(&mut page);
    let figure = "#lead-chart [data-figure=\"energy-n-dot-v\"]";
    let titles =
        page.eval(&format!("[...document.querySelectorAll('{figure} .panel-title')].map((t) => t.textContent)"));
    assert_eq!(titles, json!(["ggx · separable", "ggx · correlated", "phong · separable", "phong · correlated"]));
    // A line at 1 in each, and every bin of every image: 1 and the bias that the run's table has.
    assert_eq!(page.eval(&format!("document.querySelectorAll('{figure} line.rule').length")), json!(4));
    let saved = crate::sections::saved_csv(&mut page, "energy-n-dot-v");
    let path = dir.path().join("saved.csv");
    std::fs::write(&path, saved).unwrap();
    let [saved, truth] = [path, report.with_file_name("report-figures").join("energy_by_n_dot_v.csv")]
        .map(|path| splitsum::table::csv::Table::read(&path).unwrap());
    let values = |table: &splitsum::table::csv::Table| {
        let column = ["brdf", "masking", "alpha", "n_dot_v_from", "albedo"].map(|name| table.column(name).unwrap());
        let mut rows: Vec<String> = table
            .rows
            .iter()
            .map(|row| {
                column.map(|c| row[c].parse::<f64>().map_or_else(|_| row[c].clone(), |x| format!("{x:.9}"))).join(" ")
            })
            .collect();
        rows.sort();
        rows
    };
    assert_eq!(values(&saved), values(&truth));
    assert!(saved.rows.len() > 12, "{}", saved.rows.len());
    let dots = page.eval(&format!("document.querySelectorAll('{figure} .dot.open').length"));
    assert_eq!(dots, json!(saved.rows.len()));
    assert_clean(&page);
}
