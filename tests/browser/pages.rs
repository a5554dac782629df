//! Answers, images and tables: what is shown is what the run says, and names are only names.

use crate::chromium;
use crate::fake::Log;
use crate::fixture::{
    HOSTILE, HOSTILE_FOLDER, assert_clean, cell, finished_run, page_of, report, report_of, rows, run_of, saved,
    write_page,
};
use serde_json::{Value, json};
use splitsum::report::page::PageOptions;
use splitsum::report::page::images::{Choice, Window};
use splitsum::table::csv::Table;
use std::path::{Path, PathBuf};

const VIEWS: [&str; 6] = ["answer", "images", "compare", "live", "tables", "run"];

#[test]
fn views_fit_phone_laptop_and_desk() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    let id = cell(&report, ["sampled", "4", "0.1", "ggx", "1"]);
    page.go(&report, "");
    for (name, width, height, scheme) in
        [("phone", 390, 844, "light"), ("laptop", 1366, 768, "dark"), ("desk", 2560, 1440, "dark")]
    {
        page.resize(width, height, scheme);
        for view in VIEWS {
            page.follow(&if view == "compare" { format!("#compare?cell={id}&split=0.5") } else { format!("#{view}") });
            page.eval("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))");
            let overflow = page.eval("document.documentElement.scrollWidth - document.documentElement.clientWidth");
            assert!(overflow.as_i64().unwrap() <= 0, "{view} is {overflow} pixels too wide at {width}");
            page.screenshot(&format!("{view}-{name}-{scheme}"));
        }
    }
    assert_clean(&page);
}

#[test]
fn the_first_screen_of_a_laptop_has_the_answer() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    page.resize(1280, 720, "light");
    page.go(&report, "");
    assert_eq!(page.text("#question"), HOSTILE);
    // The case with its error: the method beside the reference, and a figure or a digest.
    assert!(page.text(".shots").contains("split-sum") && page.text(".shots").contains("reference"));
    assert!(page.text(".case figcaption").contains("relmse"), "{}", page.text(".case figcaption"));
    let bottoms = page.eval(
        "[...document.querySelectorAll('#question, .first .sentence, .shots, .lead-side :is(svg, table)')] \
         .filter((e) => e.getClientRects().length).map((e) => e.getBoundingClientRect().bottom)",
    );
    let all: Vec<f64> = bottoms.as_array().unwrap().iter().map(|bottom| bottom.as_f64().unwrap()).collect();
    assert!(all.len() >= 4 && all.iter().all(|bottom| *bottom < 720.0), "{bottoms}");
    assert_clean(&page);
}

#[test]
fn every_answer_saves_what_it_shows() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    page.go(&report, "");
    let keys = page.eval("import('report/data').then(({ model }) => model.answers.map((one) => one.name))");
    assert!(!keys.as_array().unwrap().is_empty());
    for (i, key) in keys.as_array().unwrap().iter().map(|key| key.as_str().unwrap()).enumerate() {
        let tools = format!("document.querySelector('.answer-tools[data-answer=\"{i}\"]')");
        let button = |name: &str| format!("{tools}.querySelector('[data-save={name}]')");
        let path = report.with_file_name("saved.csv");
        std::fs::write(&path, saved(&mut page, &button("csv"))).unwrap();
        let table = Table::read(&path).unwrap();
        page.eval(&format!("{tools}.querySelector('summary').click()"));
        page.wait(&format!("{tools}.querySelector('.data-table') !== null"));
        let shown = page.eval(&format!("{tools}.querySelectorAll('.data-table tbody tr').length"));
        assert_eq!(shown.as_u64().unwrap() as usize, table.rows.len().min(200), "{key}");
        if page.eval(&format!("{} !== null", button("svg"))) == json!(true) {
            let svg = saved(&mut page, &button("svg"));
            assert_eq!(roxmltree::Document::parse(&svg).err(), None, "{key}");
        }
    }
    assert_clean(&page);
}

#[test]
fn marks_are_reached_by_keyboard_and_lead_to_their_cells() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    page.resize(1366, 800, "light");
    page.go(&report, "");
    for i in 0..page.eval("document.querySelectorAll('.desk svg').length").as_u64().unwrap() {
        // One mark is a stop of the keyboard; arrows reach every other one, each with its words.
        let walked = page.eval(&format!(
            "(() => {{ const svg = document.querySelectorAll('.desk svg')[{i}], marks = [...svg.querySelectorAll('.mark')], seen = new Set(); \
             if (!marks.length) return [0, 0, 0]; \
             const stops = svg.querySelectorAll('.mark[tabindex=\"0\"]').length; marks[0].focus(); let told = 0; \
             for (let n = 0; n < 3000 && !seen.has(document.activeElement); n++) {{ const at = document.activeElement; seen.add(at); \
               told += !document.querySelector('.tip').hidden && document.querySelector('.tip').textContent === at.dataset.tip; \
               at.dispatchEvent(new KeyboardEvent('keydown', {{ key: 'ArrowRight', bubbles: true }})); }} \
             return [stops - 1, marks.length - seen.size, marks.length - told]; }})()"
        ));
        assert_eq!(walked, json!([0, 0, 0]), "figure {i}");
    }
    let cell = page.eval("document.querySelector('.desk .mark[data-cell]').dataset.cell");
    page.eval("document.querySelector('.desk .mark[data-cell]').focus()");
    page.key("Enter");
    page.wait(&format!("document.body.dataset.view === 'compare' && location.hash.includes({cell})"));
    assert_clean(&page);
}

#[test]
fn choices_and_sorting_of_the_table_are_kept_in_the_address_and_saved() {
    let Some((mut page, report, _dir)) = report(Choice::None) else { return };
    let column = |page: &mut chromium::Page, name: &str| -> Vec<String> {
        let script = format!(
            "(() => {{ const heads = [...document.querySelectorAll('.data-table th')]; \
             const i = heads.findIndex((th) => th.querySelector('[data-sort=\"{name}\"]')); \
             return [...document.querySelectorAll('.data-table tbody tr')].map((tr) => tr.children[i].title); }})()"
        );
        page.eval(&script).as_array().unwrap().iter().map(|value| value.as_str().unwrap().to_owned()).collect()
    };
    page.resize(1200, 800, "light");
    page.go(&report, "#tables");
    let all = rows(&report);
    assert_eq!(column(&mut page, "cell").len(), all.len());
    page.eval(
        "(() => { const label = [...document.querySelectorAll('.controls .choice')].find((e) => e.firstChild.textContent === 'brdf'); \
         const box = label.querySelector('select'); box.value = 'phong'; box.dispatchEvent(new Event('change')); })()",
    );
    let wanted = all.iter().filter(|row| row[4] == "phong").count();
    assert_eq!(column(&mut page, "brdf"), vec!["phong"; wanted]);
    page.click("[data-sort=rmse]");
    page.wait("location.hash.includes('sort=rmse')");
    let rmse: Vec<f64> = column(&mut page, "rmse").iter().map(|text| text.parse().unwrap()).collect();
    assert!(rmse.len() == wanted && rmse.is_sorted());
    let hash = page.eval("location.hash").as_str().unwrap().to_owned();
    page.go(&report, &hash);
    let shown = column(&mut page, "cell");
    let path = report.with_file_name("saved.csv");
    std::fs::write(&path, saved(&mut page, "document.querySelector('#view-tables .controls > button')")).unwrap();
    let (saved, truth) = (Table::read(&path).unwrap(), Table::read(&report.with_file_name("errors.csv")).unwrap());
    let value = |table: &Table, row: &[String], name: &str| row[table.column(name).unwrap()].clone();
    assert_eq!(saved.rows.iter().map(|row| value(&saved, row, "cell")).collect::<Vec<_>>(), shown);
    for row in &saved.rows {
        let id = value(&saved, row, "cell");
        let other = truth.rows.iter().find(|other| value(&truth, other, "cell") == id).unwrap();
        for name in ["rmse", "flip", "ssim"] {
            let number = |text: String| text.parse::<f64>().unwrap();
            assert_eq!(number(value(&saved, row, name)), number(value(&truth, other, name)), "{name} of {id}");
        }
    }
    assert_clean(&page);
}

#[test]
fn without_images_and_with_crops_the_page_says_so() {
    let Some((mut page, report, dir)) = report(Choice::None) else { return };
    page.go(&report, "#images");
    assert!(page.text("#view-images").contains("--no-images"));
    // Every image is linked.
    let links = page.eval("[...document.querySelectorAll('#view-images td a')].map((a) => a.href)");
    let links = links.as_array().unwrap();
    assert_eq!(links.len(), 3 * (1 + 4));
    for link in links {
        let file = link.as_str().unwrap().strip_prefix("file://").unwrap();
        assert!(Path::new(file).exists(), "{file}");
    }
    page.go(&report, "#compare");
    assert!(page.text("#view-compare").contains("Images are omitted"));
    let images = Choice::Crop(Window { x: 4, y: 6, width: 8, height: 5 });
    let run = dir.path().join("run");
    let options = PageOptions { images, out: dir.path().join("cut.html"), ..PageOptions::in_folder(&run) };
    let path = write_page(std::slice::from_ref(&run), &options);
    page.go(&path, "#compare");
    page.wait("document.querySelector('.viewer-stage canvas').dataset.ready !== undefined");
    assert!(page.text(".caption").contains("window 8 × 5 at (4, 6) of 24 × 24"));
    assert_clean(&page);
}

#[test]
fn joined_runs_keep_their_own_answers_and_images() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let axes = |samples: &str| {
        format!(
            "environment = [\"builtin:constant\"]\nalpha = [0.1, 0.5]\nmethod = [\"sampled\", \"split-sum\"]\nsamples = [{samples}]"
        )
    };
    let other = Log { device: Some("another device"), ..Log::default() };
    let runs: [PathBuf; 3] = [
        run_of(&dir.path().join("one"), &axes("1, 4, 16"), "", Log::default()),
        run_of(&dir.path().join("again"), &axes("1, 4, 16"), "", Log::default()),
        run_of(&dir.path().join("few"), &axes("1, 4"), "", other),
    ];
    let texts = |page: &mut chromium::Page, selector: &str| {
        page.eval(&format!("[...document.querySelectorAll({})].map((e) => e.textContent.trim())", json!(selector)))
    };
    let mut alone = Vec::new();
    for run in &runs {
        page.go(&page_of(run, Choice::Automatic), "");
        alone.push(json!(page.text(".first .sentence")));
    }
    assert_ne!(alone[0], alone[2]);
    let options = PageOptions { out: dir.path().join("joined.html"), ..PageOptions::in_folder(&runs[0]) };
    let joined = write_page(&runs, &options);
    page.resize(1440, 900, "light");
    page.go(&joined, "");
    assert_eq!(texts(&mut page, ".card .sentence"), json!(alone));
    // The second is no further evidence; what tells the runs apart is on the first screen.
    assert!(page.text(".joined > .warning").contains("again repeats one"), "{}", page.text(".joined > .warning"));
    assert_eq!(texts(&mut page, "#apart tbody th"), json!(["device"]));
    // A mark leads to the images of its own run.
    page.click("#run-2 .desk .mark[data-cell] path");
    page.wait("location.hash.includes('run=1')");
    page.wait("document.querySelector('.viewer-stage canvas')?.dataset.ready !== undefined");
    let pressed = "[...document.querySelectorAll('.variant[aria-pressed=true]')].map((b) => b.dataset.run)";
    assert_eq!(page.eval(pressed), json!(["1"]));
    assert!(page.text(".badge").starts_with("again"));
    assert_clean(&page);
}

#[test]
fn hostile_names_stay_text_in_every_view() {
    const NAME: &str = "=cmd|' C' \"q\", a,b\n<script>window.pwned = 3<\\script><img src=x onerror=window.pwned=4>.exr";
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/env_analytic.exr");
    std::fs::copy(golden, dir.path().join(NAME)).unwrap();
    let axes = format!(
        "environment = [\"builtin:constant\", {}]\nalpha = [0.1, 0.5]\nmethod = [\"sampled\", \"split-sum\"]\nsamples = [1, 4]",
        json!(NAME)
    );
    let excluded = format!("[[exclude]]\nenvironment = {}\nalpha = 0.5\nwhy = {}", json!(NAME), json!(HOSTILE));
    let of_map = report_of(dir.path(), &axes, &excluded);
    let failed = finished_run(dir.path(), HOSTILE_FOLDER, Some("split-sum"));
    let options = PageOptions { out: dir.path().join("failed.html"), ..PageOptions::in_folder(&failed) };
    for report in [of_map, write_page(&[failed], &options)] {
        for view in VIEWS {
            page.go(&report, &format!("#{view}"));
            page.eval("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))");
            assert_eq!(page.eval("window.pwned ?? null"), Value::Null, "{view}");
            let made = "document.querySelectorAll('img:not([src^=\"data:image/png\"]), main script').length";
            assert_eq!(page.eval(made), json!(0), "{view}");
        }
    }
    let run = page.text("#view-run");
    assert!(run.contains("the shader is broken") && run.contains(HOSTILE), "{run}");
    assert_clean(&page);
}

#[test]
fn values_that_round_to_the_same_keep_their_digits() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let axes = "environment = [\"builtin:constant\"]\nalpha = [0.22361, 0.22362]\nmethod = [\"sampled\"]\nsamples = [1, 4]\n\
                lod_bias = [0, 1.2924812503605781]";
    page.go(&report_of(dir.path(), axes, ""), "#images");
    let text = page.text(".image-table");
    assert!(text.contains("alpha 0.22361") && text.contains("alpha 0.22362"), "{text}");
    // A bare number in a label says what it is.
    assert!(text.contains("bias 1.292") && !text.contains("1.29248"), "{text}");
    assert_clean(&page);
}
