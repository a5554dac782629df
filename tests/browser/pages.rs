//! Answers, images and tables: the page shows the data of the run, passes axe-core, and escapes
//! names.

use crate::chromium::{self, Page};
use crate::fake::Log;
use crate::fixture::{
    HOSTILE, HOSTILE_FOLDER, assert_clean, cell, finished_run, report, report_of, run_of,
    write_page,
};
use serde_json::{Value, json};
use splitsum::base::csv::Table;
use splitsum::report::page::PageOptions;
use splitsum::report::page::images::Choice;
use std::path::Path;

const VIEWS: [&str; 6] = ["answer", "images", "compare", "live", "tables", "run"];
/// Where scripts/check-page.sh installs axe-core.
const AXE: &str = "target/page-tools/node_modules/axe-core/axe.min.js";

/// Loads axe-core; returns `None` and prints a line if it is not installed.
pub fn axe() -> Option<String> {
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(AXE)).ok();
    if text.is_none() {
        eprintln!("skipped: no axe-core; `sh scripts/check-page.sh` installs it (needs npm)");
        assert!(
            std::env::var_os("SPLITSUM_REQUIRE_BROWSER").is_none(),
            "SPLITSUM_REQUIRE_BROWSER is set"
        );
    }
    text
}

/// The faults of the shown view: rule, element and message.
pub fn faults(page: &mut Page) -> Vec<String> {
    let found = page.eval(
        "axe.run(document, { resultTypes: ['violations'] }).then(({ violations }) => \
         violations.flatMap((rule) => \
         rule.nodes.map((node) => `${rule.id}: ${node.html.slice(0, 160)} \
         ${node.failureSummary}`)))",
    );
    found
        .as_array()
        .unwrap()
        .iter()
        .map(|fault| fault.as_str().unwrap().to_owned())
        .collect()
}

#[test]
fn every_view_fits_every_width_and_passes_axe() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else {
        return;
    };
    let axe = axe();
    let id = cell(&report, ["sampled", "4", "0.1", "ggx", "1"]);
    let mut all = Vec::new();
    for (width, scheme) in [
        (390, "light"),
        (1280, "light"),
        (1440, "dark"),
        (1920, "light"),
    ] {
        page.resize(width, 844, scheme);
        page.go(&report, "");
        page.eval(&format!("{}; null", axe.as_deref().unwrap_or_default()));
        for view in VIEWS {
            page.follow(&if view == "compare" {
                format!("#compare?cell={id}&split=0.5")
            } else {
                format!("#{view}")
            });
            page.eval(
                "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))",
            );
            let overflow = page.eval(
                "document.documentElement.scrollWidth - document.documentElement.clientWidth",
            );
            assert!(
                overflow.as_i64().unwrap() <= 0,
                "{view} is {overflow} pixels too wide at {width}"
            );
            let found = if axe.is_some() {
                faults(&mut page)
            } else {
                Vec::new()
            };
            all.extend(
                found
                    .into_iter()
                    .map(|fault| format!("{view} at {width}, {scheme}: {fault}")),
            );
        }
    }
    assert!(all.is_empty(), "{}", all.join("\n"));
    // At this width the leading answer fills the page.
    page.follow("#answer");
    let gap = page.eval(
        "document.querySelector('.first > \
                         :last-child').getBoundingClientRect().right - \
                         document.getElementById('main').clientWidth",
    );
    assert!(gap.as_f64().unwrap() > -100.0, "{gap}");
    if axe.is_some() {
        page.eval(
            "document.querySelector('h1').remove(); \
                   document.querySelector('.kicker').style.color = '#ddd'",
        );
        let found = faults(&mut page).join("\n");
        assert!(
            found.contains("heading") && found.contains("color-contrast"),
            "axe finds no fault that was made: {found}"
        );
    }
    // The skip link is the first stop of the keyboard and leads to the view.
    page.go(&report, "");
    page.key("Tab");
    assert_eq!(page.eval("document.activeElement.id"), json!("skip"));
    page.eval("document.activeElement.click()");
    assert_eq!(page.eval("document.activeElement.id"), json!("main"));
    assert_clean(&page);
}

#[test]
fn marks_are_reached_by_keyboard_and_lead_to_their_cells() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else {
        return;
    };
    page.resize(1366, 800, "light");
    page.go(&report, "");
    // A figure is one stop of the keyboard; arrows reach each mark, each with its words.
    let walked = page.eval(
        "[...document.querySelectorAll('.desk svg')].map((svg) => { const marks = \
         [...svg.querySelectorAll('.mark')], seen = new Set(); \
         const stops = svg.querySelectorAll('.mark[tabindex=\"0\"]').length; marks[0].focus(); let \
         words = 0; \
         for (let n = 0; n < 3000 && !seen.has(document.activeElement); n++) { const at = \
         document.activeElement; seen.add(at); \
           words += !document.querySelector('.tip').hidden && \
           document.querySelector('.tip').textContent === at.dataset.tip; \
           at.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowRight', bubbles: true })); } \
         return [stops - 1, marks.length - seen.size, marks.length - words].join(); })",
    );
    assert!(
        walked
            .as_array()
            .is_some_and(|all| !all.is_empty() && all.iter().all(|one| one == "0,0,0")),
        "{walked}"
    );
    let cell = page.eval("document.querySelector('.desk .mark[data-cell]').dataset.cell");
    page.eval("document.querySelector('.desk .mark[data-cell]').focus()");
    page.key("Enter");
    page.wait(&format!(
        "document.body.dataset.view === 'compare' && location.hash.includes({cell})"
    ));
    assert_clean(&page);
}

#[test]
fn the_saved_table_has_the_rows_that_the_address_names() {
    let Some((mut page, report, _dir)) = report(Choice::None) else {
        return;
    };
    page.go(&report, "#tables?brdf=phong");
    page.click("[data-sort=rmse]");
    page.wait("location.hash.includes('sort=rmse')");
    let hash = page.eval("location.hash").as_str().unwrap().to_owned();
    page.go(&report, &hash);
    let text = page.eval(
        "(() => { let saved; URL.createObjectURL = (blob) => { saved = blob; return 'data:,'; }; \
         document.querySelector('#view-tables .controls > button').click(); return saved.text(); \
         })()",
    );
    let path = report.with_file_name("saved.csv");
    std::fs::write(&path, text.as_str().unwrap()).unwrap();
    let column = |path: &Path, name: &str| -> Vec<String> {
        let table = Table::read(path).unwrap();
        let column = table.column(name).unwrap();
        table
            .rows
            .into_iter()
            .map(|mut row| row.swap_remove(column))
            .collect()
    };
    let all = column(&report.with_file_name("errors.csv"), "brdf");
    assert_eq!(
        column(&path, "brdf"),
        vec!["phong"; all.iter().filter(|name| *name == "phong").count()]
    );
    assert!(
        column(&path, "rmse")
            .iter()
            .map(|text| text.parse::<f64>().unwrap())
            .is_sorted()
    );
    assert_clean(&page);
}

#[test]
fn joined_runs_keep_their_own_answers_and_images() {
    let Some(mut page) = chromium::open() else {
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    let run = |name: &str, samples: &str, device| {
        let axes = format!(
            "environment = [\"builtin:constant\"]\nalpha = [0.1, 0.5]\nmethod = \
             [\"sampled\", \"split-sum\"]\nsamples = [{samples}]"
        );
        run_of(
            &dir.path().join(name),
            &axes,
            "",
            Log {
                device,
                ..Log::default()
            },
        )
    };
    let runs = [
        run("one", "1, 4, 16", None),
        run("again", "1, 4, 16", None),
        run("few", "1, 4", Some("another device")),
    ];
    let options = PageOptions {
        out: dir.path().join("joined.html"),
        ..PageOptions::in_folder(&runs[0])
    };
    page.resize(1440, 900, "light");
    page.go(&write_page(&runs, &options), "");
    assert_eq!(
        page.eval("document.querySelectorAll('.card .sentence').length"),
        json!(3)
    );
    // The first screen shows how the runs differ.
    assert_eq!(page.text("#apart tbody th").trim(), "device");
    // A mark leads to the images of its run.
    page.click("#run-2 .desk .mark[data-cell] path");
    page.wait("location.hash.includes('run=1')");
    page.wait("document.querySelector('.viewer-stage canvas')?.dataset.ready !== undefined");
    let pressed =
        "[...document.querySelectorAll('.variant[aria-pressed=true]')].map((b) => b.dataset.run)";
    assert_eq!(page.eval(pressed), json!(["1"]));
    assert!(page.text(".badge").starts_with("again"));
    assert_clean(&page);
}

#[test]
fn hostile_names_stay_text_in_every_view() {
    const NAME: &str = "=cmd|' C' \"q\", a,b\n<script>window.pwned = 3<\\script><img src=x \
                        onerror=window.pwned=4>.exr";
    let Some(mut page) = chromium::open() else {
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/env_analytic.exr");
    std::fs::copy(golden, dir.path().join(NAME)).unwrap();
    let axes = format!(
        "environment = [\"builtin:constant\", {}]\nalpha = [0.1, 0.5]\nmethod = \
         [\"sampled\", \"split-sum\"]\nsamples = [1, 4]",
        json!(NAME)
    );
    let excluded = format!(
        "[[exclude]]\nenvironment = {}\nalpha = 0.5\nwhy = {}",
        json!(NAME),
        json!(HOSTILE)
    );
    let of_map = report_of(dir.path(), &axes, &excluded);
    let failed = finished_run(dir.path(), HOSTILE_FOLDER, Some("split-sum"));
    let options = PageOptions {
        out: dir.path().join("failed.html"),
        ..PageOptions::in_folder(&failed)
    };
    for report in [of_map, write_page(&[failed], &options)] {
        for view in VIEWS {
            page.go(&report, &format!("#{view}"));
            page.eval(
                "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))",
            );
            assert_eq!(page.eval("window.pwned ?? null"), Value::Null, "{view}");
            let made = "document.querySelectorAll('img:not([src^=\"data:image/png\"]), main \
                        script').length";
            assert_eq!(page.eval(made), json!(0), "{view}");
        }
    }
    let run = page.text("#view-run");
    assert!(
        run.contains("the shader is broken") && run.contains(HOSTILE),
        "{run}"
    );
    assert_clean(&page);
}
