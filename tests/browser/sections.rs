//! Section by section: sizes and places of what is seen, labels for people, what is excluded, equal time, the probe by keyboard, the
//! address, hostile names in data.

use crate::chromium::{self, Page};
use crate::fake::{Fake, Log};
use crate::fixture::{HOSTILE, Quiet, assert_clean, cell, report};
use crate::viewer::{open_compare, shown};
use serde_json::{Value, json};
use splitsum::runner::{Plan, RenderFault, Renderer, RunOptions, run};
use splitsum::study::report::images::Choice;
use splitsum::study::report::{ReportOptions, write};
use splitsum::table::csv::Table;
use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::atomic::AtomicBool;

/// The report of a finished run of an experiment whose axes are given.
pub fn report_of(dir: &Path, axes: &str, rest: &str) -> PathBuf {
    write(&ReportOptions::of_run(&run_of(&dir.join("run"), axes, rest, Log::default()))).unwrap().path
}

/// A finished run in `dir` of an experiment whose axes are given.
pub fn run_of(dir: &Path, axes: &str, rest: &str, log: Log) -> PathBuf {
    let head = "name = \"sections\"\nsize = [24, 24]\nreference = { samples = 64 }";
    run_of_text(dir, &format!("{head}\n[axes]\n{axes}\n{rest}\n"), log)
}

/// A finished run in `dir` of an experiment as written.
pub fn run_of_text(dir: &Path, text: &str, log: Log) -> PathBuf {
    let file = dir.with_file_name("sections.toml");
    let plan = Plan::from_text(&file, text, &[]).unwrap_or_else(|error| panic!("{error}"));
    let stop = AtomicBool::new(false);
    let fail_fast = log.broken.is_none();
    let options = RunOptions { dir: dir.to_owned(), stop: &stop, command_line: Vec::new(), fail_fast, trace: false };
    let log = Rc::new(RefCell::new(log));
    let mut make = || -> Result<Box<dyn Renderer>, RenderFault> { Ok(Box::new(Fake(log.clone()))) };
    run(&plan, &mut make, &options, &mut Quiet).unwrap_or_else(|error| panic!("{error}"));
    options.dir
}

/// What the button `CSV` of a figure saves.
pub fn saved_csv(page: &mut Page, figure: &str) -> String {
    let script = format!(
        "(() => {{ const make = URL.createObjectURL; let saved; URL.createObjectURL = (blob) => {{ saved = blob; return 'data:,'; }}; \
         [...document.querySelectorAll('[data-figure=\"{figure}\"] .figure-tools button')].find((b) => b.textContent === 'CSV').click(); \
         URL.createObjectURL = make; return saved.text(); }})()"
    );
    page.eval(&script).as_str().unwrap().to_owned()
}

pub fn wait_for_figures(page: &mut Page) {
    page.wait("[...document.querySelectorAll('.view:not([hidden]) .figure .stage')].every((stage) => stage.querySelector('svg'))");
}

#[test]
fn pictures_of_the_image_table_have_one_size() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    for width in [390, 1440, 3840] {
        page.resize(width, 900, "light");
        page.go(&report, "#images");
        let sizes = "[...new Set([...document.querySelectorAll('.image-table .thumb canvas')].map((c) => { \
                     const b = c.getBoundingClientRect(); return `${Math.round(b.width)} x ${Math.round(b.height)}`; }))]";
        page.wait("document.querySelector('.image-table .thumb canvas').width === 24");
        assert_eq!(page.eval(sizes).as_array().unwrap().len(), 1, "{width}: {}", page.eval(sizes));
        // One picture of each of the three scenes is named, to the ear too.
        assert_eq!(page.eval("document.querySelectorAll('.lowest').length"), json!(3));
        assert_eq!(
            page.eval("[...document.querySelectorAll('.thumb')].filter((b) => b.textContent.includes('relMSE lowest ')).length"),
            json!(3)
        );
    }
    assert_clean(&page);
}

#[test]
fn sections_open_at_their_top_and_keep_their_place() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    page.resize(1200, 500, "light");
    for view in ["answer", "images", "compare", "live", "plots", "tables", "run"] {
        page.go(&report, &format!("#{view}"));
        page.eval("new Promise((done) => setTimeout(done, 150))");
        let hidden = "(() => { const first = document.querySelector('.view:not([hidden])').firstElementChild; \
                      return document.querySelector('.bar').getBoundingClientRect().bottom - first.getBoundingClientRect().top; })()";
        assert!(page.eval(hidden).as_f64().unwrap() <= 0.0, "{view}: {} pixels lie under the bar", page.eval(hidden));
        assert_eq!(page.eval("scrollY"), json!(0), "{view}");
    }
    // Pages are like tabs: each keeps its place, and a new one starts at its top.
    page.go(&report, "#plots");
    wait_for_figures(&mut page);
    page.eval("scrollTo(0, 300)");
    page.key("r");
    assert_eq!(page.eval("[document.body.dataset.view, scrollY]"), json!(["run", 0]));
    page.key("p");
    wait_for_figures(&mut page);
    assert_eq!(page.eval("[document.body.dataset.view, scrollY]"), json!(["plots", 300]));
    // What opens another page loses the focus; the keyboard goes on in that page, not at the menu.
    page.eval("document.querySelector('.figure .stage svg').focus()");
    page.key("End");
    page.key("Enter");
    assert_eq!(page.eval("[document.body.dataset.view, document.activeElement.id]"), json!(["compare", "main"]));
    // A focused element is never under the bar.
    assert!(
        page.eval("parseFloat(getComputedStyle(document.documentElement).scrollPaddingTop)").as_f64().unwrap() >= 50.0
    );
    assert_clean(&page);
}

#[test]
fn names_tell_the_truth_from_the_method_and_one_image_is_not_the_lowest() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let axes = "environment = [\"builtin:constant\"]\nbrdf = [\"ggx\"]\nalpha = [0.1, 0.5]\nmethod = [\"reference\"]\nsamples = [32]";
    let report = report_of(dir.path(), axes, "");
    page.go(&report, "#images");
    page.wait("document.querySelectorAll('.image-table thead th').length > 2");
    let heads =
        page.eval("[...document.querySelectorAll('.image-table thead th')].slice(1).map((th) => th.textContent)");
    assert_eq!(heads[0], "reference (truth)");
    assert!(heads[1].as_str().unwrap().starts_with("reference"), "{heads}");
    assert_ne!(heads[0], heads[1]);
    assert_eq!(page.eval("document.querySelectorAll('.lowest').length"), json!(0));
    // Without a specular term the diffuse one names the image.
    let axes = "environment = [\"builtin:constant\"]\nbrdf = [\"ggx\"]\nmethod = [\"none\"]\ndiffuse = [\"sh9\", \"irradiance-map\"]\n\
                irradiance_size = [[16, 8], [8, 4]]\nirradiance_sample_count = [[16, 8], [32, 8]]";
    let dir = tempfile::tempdir().unwrap();
    let report = report_of(dir.path(), axes, "");
    page.go(&report, "#images");
    page.wait("document.querySelectorAll('.image-table thead th').length > 2");
    let heads =
        page.eval("[...document.querySelectorAll('.image-table thead th')].slice(2).map((th) => th.textContent)");
    let heads: Vec<&str> = heads.as_array().unwrap().iter().map(|head| head.as_str().unwrap()).collect();
    assert!(heads.contains(&"sh9") && heads.contains(&"irradiance-map 16x8, 32x8 samples"), "{heads:?}");
    assert_clean(&page);
}

const LONG_ALPHA: &str = "0.223606797749979";
const AXES: &str = "environment = [\"builtin:constant\"]\nbrdf = [\"ggx\", \"phong\"]\nalpha = [0.1, 0.223606797749979, 0.5]\n\
                    method = [\"sampled\", \"split-sum\"]\nsamples = [1, 4, 16]";
const TIMING: &str = "[timing]\nwarmup = 1\nrounds = 9";

#[test]
fn labels_are_rounded_and_files_are_exact() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let report = report_of(dir.path(), AXES, TIMING);
    page.resize(1200, 900, "light");
    for view in ["answer", "images", "compare", "plots", "tables"] {
        page.go(&report, &format!("#{view}"));
        page.wait("document.querySelectorAll('.view:not([hidden]) svg, .view:not([hidden]) canvas, .view:not([hidden]) tbody tr').length > 0");
        let shown = "document.querySelector('.view:not([hidden])').innerText \
                     + [...document.querySelectorAll('.view:not([hidden]) svg text')].map((t) => t.textContent).join(' ')";
        let text = page.eval(shown).as_str().unwrap().to_owned();
        assert!(!text.contains("0.22360"), "{view}: {text}");
        assert!(text.contains("0.2236"), "{view}: {text}");
    }
    page.go(&report, "#plots");
    wait_for_figures(&mut page);
    assert!(saved_csv(&mut page, "break-even").contains(LONG_ALPHA));
    assert_clean(&page);
}

#[test]
fn values_that_round_to_the_same_keep_their_digits() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let axes = "environment = [\"builtin:constant\"]\nbrdf = [\"ggx\"]\nalpha = [0.22361, 0.22362]\nmethod = [\"sampled\"]\nsamples = [1, 4]\n\
                lod_bias = [0, 1.2924812503605781]";
    let report = report_of(dir.path(), axes, "");
    page.go(&report, "#images");
    let text = page.text(".image-table");
    assert!(text.contains("α 0.22361") && text.contains("α 0.22362"), "{text}");
    // A bare number in a label says what it is.
    assert!(text.contains("sampled 4 bias 1.292") && !text.contains("1.2924"), "{text}");
    assert_clean(&page);
}

#[test]
fn excluded_combinations_are_hatched_and_say_why() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    page.resize(1200, 900, "light");
    page.go(&report, "#plots");
    wait_for_figures(&mut page);
    for figure in ["break-even", "equal-time"] {
        let map = format!("[data-figure=\"{figure}\"]");
        let cells = page.eval(&format!(
            "[...document.querySelectorAll('{map} .cell')].map((cell) => [cell.classList.contains('excluded-cell'), \
             cell.querySelector('rect').getAttribute('fill').startsWith('url('), cell.querySelector('title').textContent])"
        ));
        let excluded: Vec<&Value> = cells.as_array().unwrap().iter().filter(|cell| cell[0] == true).collect();
        assert_eq!((cells.as_array().unwrap().len(), excluded.len()), (4, 1), "{figure}: {cells}");
        assert_eq!(excluded[0][1], json!(true));
        let title = excluded[0][2].as_str().unwrap();
        assert!(
            title.contains("phong · α 0.5: excluded by the experiment: phong has \"<b>no</b>\" alpha of 0.5"),
            "{title}"
        );
        let legend = page.text(&format!("{map} .legend"));
        assert!(legend.contains("excluded by the experiment") && !legend.contains("no result"), "{legend}");
    }
    // Not reached is another thing.
    let answer = Table::read(&report.with_file_name("answers").join("break_even.csv")).unwrap();
    let reached = answer.rows.iter().any(|row| row.iter().any(|field| field == "never"));
    assert_eq!(page.text("[data-figure=\"break-even\"] .legend").contains("not reached"), reached);
    assert_clean(&page);
}

#[test]
fn equal_time_is_shown_with_its_interval() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let report = report_of(dir.path(), AXES, TIMING);
    page.resize(1200, 900, "light");
    page.go(&report, "#answer");
    page.wait("document.querySelectorAll('[data-figure=\"equal-time\"] .cell').length === 6");
    page.go(&report, "#plots");
    wait_for_figures(&mut page);
    let csv = saved_csv(&mut page, "equal-time");
    let path = dir.path().join("saved.csv");
    std::fs::write(&path, csv).unwrap();
    let (shown, truth) =
        (Table::read(&path).unwrap(), Table::read(&report.with_file_name("answers").join("break_even.csv")).unwrap());
    assert_eq!(shown.rows.len(), truth.rows.len());
    for name in [
        "brdf",
        "alpha",
        "crossing",
        "crossing_lo",
        "crossing_hi",
        "interval_from",
        "at_equal_time",
        "samples_in_equal_time",
        "samples_in_equal_time_lo",
        "samples_in_equal_time_hi",
    ] {
        let column = |table: &Table| {
            let place = table.column(name).unwrap_or_else(|error| panic!("{error}"));
            let normal = |text: &String| text.parse::<f64>().map_or(text.clone(), |x| format!("{x}"));
            table.rows.iter().map(|row| normal(&row[place])).collect::<Vec<_>>()
        };
        assert_eq!(column(&shown), column(&truth), "{name}");
    }
    // Both marks of every case of the first facet, each with its line.
    let marks = page.eval(
        "(() => { const svg = document.querySelector('[data-figure^=\"equal-time-intervals\"] .stage svg'); \
         return [svg.querySelectorAll('circle.dot').length, svg.querySelectorAll('rect.dot').length, svg.querySelectorAll('g > line[opacity]').length]; })()",
    );
    assert_eq!(marks, json!([3, 3, 6]));
    assert_clean(&page);
}

#[test]
fn flipping_back_shades_nothing_anew() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    // A shading is drawn into a texture of its own; what follows only places it.
    page.before_load(
        "window.shadings = 0; const attach = WebGL2RenderingContext.prototype.framebufferTexture2D; \
         WebGL2RenderingContext.prototype.framebufferTexture2D = function (...all) { window.shadings++; return attach.apply(this, all); };",
    );
    let id = cell(&report, ["sampled", "1", "0.1", "ggx", "1"]);
    open_compare(&mut page, &report, &id);
    page.wait("shadings > 0");
    let first = page.eval("shadings").as_u64().unwrap();
    page.key("2");
    page.key("3");
    assert_eq!(page.eval("shadings").as_u64().unwrap(), first + 2);
    for key in ["1", "2", "3", "2", "1"] {
        page.key(key);
    }
    assert_eq!(page.eval("shadings").as_u64().unwrap(), first + 2);
    // A setting changes what is seen of every image.
    page.key("]");
    page.key("2");
    assert_eq!(page.eval("shadings").as_u64().unwrap(), first + 4);
    assert_clean(&page);
}

#[test]
fn the_probe_moves_by_keyboard() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    let id = cell(&report, ["sampled", "1", "0.1", "ggx", "1"]);
    open_compare(&mut page, &report, &id);
    // It starts in the middle.
    assert!(page.text(".probe h2").contains("(12, 12)"), "{}", page.text(".probe h2"));
    let press = |page: &mut Page, key: &str| {
        page.eval(&format!(
            "document.body.dispatchEvent(new KeyboardEvent('keydown', {{ key: '{key}', shiftKey: true, bubbles: true }}))"
        ));
    };
    for key in ["ArrowRight", "ArrowRight", "ArrowUp"] {
        press(&mut page, key);
    }
    assert!(page.text(".probe h2").contains("(14, 11) · pinned"), "{}", page.text(".probe h2"));
    assert!(page.text("#announcer").contains("texel (14, 11)") && page.text("#announcer").contains("sampled 1"));
    for _ in 0..30 {
        press(&mut page, "ArrowLeft");
    }
    assert!(page.text(".probe h2").contains("(0, 11)"));
    assert_eq!(shown(&mut page), id, "arrows with shift choose no image");
    assert_clean(&page);
}

#[test]
fn the_address_is_written_seldom_and_read_with_care() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    page.before_load(
        "window.writes = 0; const replace = History.prototype.replaceState; \
         History.prototype.replaceState = function (...all) { window.writes++; return replace.apply(this, all); };",
    );
    let id = cell(&report, ["sampled", "1", "0.1", "ggx", "1"]);
    open_compare(&mut page, &report, &id);
    let writes = page.eval(
        "(() => { const e = document.getElementById('exposure'), before = writes; \
         for (let i = 0; i < 200; i++) { e.value = i / 50; e.dispatchEvent(new Event('input')); } return writes - before; })()",
    );
    // Browsers refuse more than a hundred in half a minute.
    assert!(writes.as_u64().unwrap() < 10, "{writes}");
    page.wait("location.hash.includes('ev=4')");
    // What was not written yet is not written over the next page.
    page.eval("(() => { const e = document.getElementById('exposure'); e.value = 2; e.dispatchEvent(new Event('input')); e.value = 3; e.dispatchEvent(new Event('input')); })()");
    page.key("p");
    page.eval("new Promise((done) => setTimeout(done, 600))");
    assert_eq!(page.eval("location.hash"), json!("#plots"));
    page.eval("history.back()");
    page.wait("document.body.dataset.view === 'compare'");
    assert!(page.eval("location.hash.includes('ev=3')") == json!(true), "{}", page.eval("location.hash"));
    // A broken address shows something.
    page.go(&report, "#compare?cell=%&x=%E0%A4%A");
    page.wait("document.querySelector('.viewer-stage canvas').dataset.ready !== undefined");
    assert_clean(&page);
}

#[test]
fn hostile_file_names_are_text_in_every_section() {
    const NAME: &str = "=cmd|' C' \"q\", a,b\n<script>window.pwned = 3<\\script><img src=x onerror=window.pwned=4>.exr";
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/env_analytic.exr");
    std::fs::copy(golden, dir.path().join(NAME)).unwrap();
    let axes = format!(
        "environment = [\"builtin:constant\", {}]\nbrdf = [\"ggx\"]\nalpha = [0.1, 0.5]\nmethod = [\"sampled\", \"split-sum\"]\nsamples = [1, 4]",
        json!(NAME)
    );
    let report = report_of(
        dir.path(),
        &axes,
        &format!("[[exclude]]\nenvironment = {}\nalpha = 0.5\nwhy = {}", json!(NAME), json!(HOSTILE)),
    );
    page.resize(1200, 900, "light");
    for view in ["answer", "images", "compare", "live", "plots", "tables", "run"] {
        page.go(&report, &format!("#{view}"));
        page.eval("new Promise((done) => setTimeout(done, 200))");
        assert_eq!(page.eval("window.pwned ?? null"), Value::Null, "{view}");
        assert_eq!(page.eval("document.querySelectorAll('img, main script').length"), json!(0), "{view}");
    }
    // The name stands whole where values do.
    page.go(&report, "#tables");
    assert_eq!(
        page.eval(&format!(
            "[...document.querySelectorAll('.data-table td')].some((td) => td.textContent === {})",
            json!(NAME)
        )),
        json!(true)
    );
    page.go(&report, "#plots");
    wait_for_figures(&mut page);
    assert!(page.text("[data-figure=\"break-even\"] .excluded-cell title").contains(HOSTILE));
    assert_clean(&page);
}
