//! The report in a real browser, opened from disk: what a reader sees, presses and saves. Skips with a line without Chromium.

mod access;
mod charts;
mod chromium;
mod compare;
mod contrast;
mod failed;
#[path = "../numeric/runner/fake.rs"]
mod fake;
mod fixture;
mod joined;
mod labels;
mod leads;
mod live;
mod live_pixels;
mod sections;
mod tables;
mod viewer;

use chromium::Page;
use fixture::{HOSTILE, HOSTILE_FOLDER, SIDE, assert_clean, cell, finished_run, report, rows};
use serde_json::{Value, json};
use splitsum::study::report::images::{Choice, Window};
use splitsum::study::report::{ReportOptions, write};
use std::path::Path;
use viewer::open_compare;

#[test]
fn the_first_screen_answers_with_numbers_and_hostile_names_stay_text() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    let ready = page.go(&report, "");
    println!("interactive after {ready} ms");
    assert!(ready < 10_000.0, "{ready} ms");
    assert_eq!(page.text("#question"), HOSTILE);
    assert_eq!(page.text(".headline-number strong"), "16");
    let sentence = page.text(".sentence");
    assert!(
        sentence.contains("From 16 samples a pixel on, sampled is closer to the reference than split-sum"),
        "{sentence}"
    );
    assert!(page.text(".warning").contains("CPU driver"));
    assert!(page.text(".device").contains("fake · formula"));
    // Where and when stand on the first screen, the date in one piece.
    page.resize(1440, 900, "light");
    let bottoms = "[...document.querySelectorAll('.device, .warning')].map((e) => e.getBoundingClientRect().bottom)";
    let bottoms = page.eval(bottoms);
    assert!(bottoms.as_array().unwrap().iter().all(|bottom| bottom.as_f64().unwrap() < 900.0), "{bottoms}");
    assert!(page.text(".device").ends_with(" UTC"), "{}", page.text(".device"));
    assert!(page.eval("document.querySelectorAll('.lead-more > .facts > li').length").as_u64().unwrap() <= 5);
    page.wait("document.querySelectorAll('.lead-figure svg path').length > 2");
    page.go(&report, "#run");
    let run = page.text("#view-run");
    assert!(run.contains("phong has \"<b>no</b>\" alpha of 0.5 & </script>") && run.contains(HOSTILE), "{run}");
    assert_eq!(page.eval("window.pwned ?? null"), Value::Null);
    assert_eq!(page.eval("document.querySelectorAll('img, b:not(.warning b):not(.thumb-text b)').length"), json!(0));
    assert_clean(&page);
}

#[test]
fn tables_sort_and_filter_and_lead_to_images() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    page.resize(1200, 800, "light");
    page.go(&report, "#tables");
    let column = |page: &mut Page, name: &str| {
        let script = format!(
            "(() => {{ const heads = [...document.querySelectorAll('.data-table th')]; \
             const i = heads.findIndex((th) => th.querySelector('[data-sort=\"{name}\"]')); \
             return [...document.querySelectorAll('.data-table tbody tr')].map((tr) => Number(tr.children[i].title)); }})()"
        );
        page.eval(&script).as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect::<Vec<f64>>()
    };
    page.click("[data-sort=rmse]");
    let ascending = column(&mut page, "rmse");
    assert_eq!(ascending.len(), rows(&report).len());
    assert!(ascending.is_sorted());
    page.click("[data-sort=rmse]");
    assert!(column(&mut page, "rmse").is_sorted_by(|a, b| a >= b));
    page.wait("location.hash === '#tables?sort=-rmse'");
    page.eval("(() => { const e = document.querySelector('input[type=search]'); e.value = 'samples=16 phong'; e.dispatchEvent(new Event('input')); })()");
    assert!(column(&mut page, "samples").iter().all(|samples| *samples == 16.0));
    assert_eq!(column(&mut page, "alpha"), [0.1, 0.1]);
    page.click(".data-table tbody td button");
    page.wait("document.body.dataset.view === 'compare'");
    let wanted = cell(&report, ["sampled", "16", "0.1", "phong", "1"]);
    page.wait(&format!("document.querySelector('.viewer-stage canvas').dataset.shown === '{wanted}'"));
    assert_clean(&page);
}

#[test]
fn images_and_plots_lead_into_the_comparison() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    page.resize(1200, 900, "light");
    page.go(&report, "#images?mode=error");
    // 3 scenes (one of four combinations is excluded), each the reference and 4 ways to make it.
    assert_eq!(page.eval("document.querySelectorAll('.image-table tbody tr').length"), json!(3));
    assert_eq!(page.eval("document.querySelectorAll('.image-table .thumb').length"), json!(15));
    page.wait(&format!("document.querySelector('.image-table .thumb canvas').width === {SIDE}"));
    page.click(".image-table tbody tr:nth-child(2) td:nth-child(5) .thumb");
    page.wait("document.body.dataset.view === 'compare'");
    page.go(&report, "#plots");
    page.wait("[...document.querySelectorAll('.figure .stage')].every((stage) => stage.querySelector('svg'))");
    let names =
        page.eval("[...document.querySelectorAll('.figure')].map((figure) => figure.dataset.figure.split('-')[0])");
    for name in ["convergence", "time", "break", "n", "visibility", "passes"] {
        assert!(names.as_array().unwrap().contains(&json!(name)), "{name} is not among {names}");
    }
    page.click(".figure-tools button");
    assert!(page.eval("document.querySelectorAll('.figure-table tbody tr').length").as_u64().unwrap() > 3);
    // Every value of every figure is reached by keyboard and leads to its images, in the table too; what is made once has none.
    let figures = page.eval("document.querySelectorAll('.figure').length").as_u64().unwrap();
    for i in 0..figures {
        let script = format!(
            "(() => {{ const figure = document.querySelectorAll('.figure')[{i}], svg = figure.querySelector('.stage svg'), seen = new Set(); \
             if (figure.dataset.figure === 'passes-precompute') return [0, 0, 'compare']; \
             const press = (key) => svg.dispatchEvent(new KeyboardEvent('keydown', {{ key, bubbles: true }})); \
             svg.focus(); press('Home'); \
             for (let n = 0; n < 500 && !seen.has(svg.dataset.at); n++) {{ seen.add(svg.dataset.at); press('ArrowRight'); }} \
             const values = svg.querySelectorAll('.dot.open, .cell, rect.open').length; \
             const table = figure.querySelector('.figure-table'); if (!table.firstChild) figure.querySelector('.figure-tools button').click(); \
             const rows = [...table.querySelectorAll('tbody tr')].filter((row) => !row.querySelector('button')).length; \
             const hidden = figure.querySelector('.tip').hidden; press('Enter'); const view = document.body.dataset.view; \
             history.back(); return [values - seen.size + (hidden ? 1000 : 0), rows, view]; }})()"
        );
        assert_eq!(page.eval(&script), json!([0, 0, "compare"]), "figure {i}");
        page.wait("document.body.dataset.view === 'plots'");
        page.wait("[...document.querySelectorAll('.figure .stage')].every((stage) => stage.querySelector('svg'))");
    }
    // Every drawing can be read by a screen reader, and every button has a name.
    let unnamed = page.eval(
        "[...document.querySelectorAll('.stage svg')].filter((svg) => !svg.querySelector('desc') || !svg.getAttribute('aria-labelledby')).length \
         + [...document.querySelectorAll('button')].filter((b) => !b.textContent.trim() && !b.getAttribute('aria-label')).length",
    );
    assert_eq!(unnamed, json!(0));
    assert_clean(&page);
}

#[test]
fn without_images_and_with_crops_the_page_says_so() {
    let Some((mut page, report, dir)) = report(Choice::None) else { return };
    page.go(&report, "#images");
    assert!(page.text("#view-images").contains("--no-images"));
    // Every image is linked, and there is no control without an effect.
    let links = page.eval("[...document.querySelectorAll('#view-images td a')].map((a) => a.href)");
    let links = links.as_array().unwrap();
    assert_eq!(links.len(), 3 * (1 + 4));
    for link in links {
        let file = link.as_str().unwrap().strip_prefix("file://").unwrap();
        assert!(Path::new(file).exists(), "{file}");
    }
    assert_eq!(page.eval("document.querySelectorAll('#view-images :is(input, select, .segments)').length"), json!(0));
    page.go(&report, "#compare");
    assert!(page.text("#view-compare").contains("Images were left out"));
    assert_eq!(page.eval("document.querySelectorAll('#view-compare :is(input, canvas)').length"), json!(0));
    let crop = Choice::Crop(Window { x: 4, y: 6, width: 8, height: 5 });
    let options = ReportOptions {
        images: crop,
        out: Some(dir.path().join("cut.html")),
        ..ReportOptions::of_run(&dir.path().join("run"))
    };
    let written = write(&options).unwrap();
    let id = cell(&report, ["sampled", "1", "0.1", "ggx", "1"]);
    open_compare(&mut page, &written.path, &id);
    assert!(page.text(".caption").contains("window 8 × 5 at (4, 6) of 24 × 24"));
    let link = page.eval("document.querySelector('.panel a').href");
    let file = link.as_str().unwrap().strip_prefix("file://").unwrap().to_owned();
    assert!(Path::new(&file).exists(), "{file}");
    assert_clean(&page);
}

#[test]
fn joined_runs_state_their_differences_and_failed_cells_their_reasons() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let dirs =
        vec![finished_run(dir.path(), HOSTILE_FOLDER, None), finished_run(dir.path(), "right", Some("split-sum"))];
    let edit = dirs[1].join("provenance.json");
    let text = std::fs::read_to_string(&edit).unwrap().replace("\"formula\",", "\"another driver\",");
    std::fs::write(&edit, text).unwrap();
    let written = write(&ReportOptions {
        dirs: dirs.clone(),
        out: Some(dir.path().join("joined.html")),
        ..ReportOptions::of_run(&dirs[0])
    })
    .unwrap();
    page.go(&written.path, "#run");
    let run = page.text("#view-run");
    assert!(run.contains("What tells the runs apart") && run.contains("another driver"), "{run}");
    assert!(run.contains("the shader is broken"), "{run}");
    page.go(&written.path, "");
    assert!(page.text("#view-answer").contains("cells failed"));
    page.go(&written.path, "#images");
    assert!(
        page.text(".image-table").contains(&format!("{HOSTILE_FOLDER} sampled 1"))
            && page.text(".image-table").contains("right sampled 1")
    );
    assert_clean(&page);
}

#[test]
fn pages_fit_phone_laptop_and_4k_in_both_schemes() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    let id = cell(&report, ["sampled", "4", "0.1", "ggx", "1"]);
    for (name, width, height) in [("phone", 390, 844), ("laptop", 1440, 900), ("4k", 3840, 2160)] {
        for scheme in ["light", "dark"] {
            page.resize(width, height, scheme);
            for view in ["answer", "images", "compare", "live", "plots", "tables", "run"] {
                let hash = if view == "compare" { format!("#compare?cell={id}&split=0.5") } else { format!("#{view}") };
                page.go(&report, &hash);
                page.eval("new Promise((done) => setTimeout(done, 150))");
                let overflow = page.eval("document.documentElement.scrollWidth - document.documentElement.clientWidth");
                assert!(overflow.as_i64().unwrap() <= 0, "{view} is {overflow} pixels too wide at {width}");
                page.screenshot(&format!("{view}-{name}-{scheme}"));
            }
        }
    }
    assert_clean(&page);
}
