//! The report in a real browser, opened from disk: what a reader sees, presses and saves. Skips with a line without Chromium.

mod charts;
mod chromium;
mod compare;
mod contrast;
#[path = "../numeric/experiment/fake.rs"]
mod fake;
mod joined;
mod leads;
mod live;
mod sections;
mod tables;

use chromium::Page;
use fake::{ERROR_AT_ONE, Fake, Log, SPLIT_SUM_ERROR};
use half::f16;
use serde_json::{Value, json};
use splitsum::experiment::{Plan, Progress, RenderFault, Renderer, RunOptions, run};
use splitsum::pixels::exr;
use splitsum::report::images::{Choice, Window};
use splitsum::report::{ReportOptions, write};
use splitsum::table::csv::Table;
use splitsum::tonemap::ToneCurve;
use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::atomic::AtomicBool;

/// A name that would run, close elements or start a formula if it were not inert.
const HOSTILE: &str = r#"=1+1, "quoted"
</script><script>window.pwned = 1</script><img src=x onerror='window.pwned = 2'> {{ 7 * 7 }}"#;
/// The same for a folder, whose name becomes a label and part of links.
const HOSTILE_FOLDER: &str = r#"le'ft "<b>#1?%41"#;
const SIDE: u32 = 24;

struct Quiet;

impl Progress for Quiet {
    fn start(&mut self, _: usize, _: usize) {}
    fn step(&mut self, _: &str, _: Option<&str>) {}
    fn note(&mut self, _: &str) {}
}

/// A finished run of the renderer made of formulas; the folder's name is hostile too.
fn finished_run(dir: &Path, name: &str, broken: Option<&'static str>) -> PathBuf {
    let why = json!("phong has \"<b>no</b>\" alpha of 0.5 & </script>");
    let text = format!(
        "name = {}\nquestion = {}\nsize = [{SIDE}, {SIDE}]\nreference = {{ samples = 64 }}\n[axes]\n\
         environment = [\"builtin:constant\"]\nbrdf = [\"ggx\", \"phong\"]\nalpha = [0.1, 0.5]\n\
         method = [\"sampled\", \"split-sum\"]\nsamples = [1, 4, 16]\nexposure = [1, 10]\n\
         [[exclude]]\nbrdf = \"phong\"\nalpha = 0.5\nwhy = {why}\n[timing]\nwarmup = 1\nrounds = 3\n",
        json!("hostile"),
        json!(HOSTILE),
    );
    let plan = Plan::from_text(Path::new("hostile.toml"), &text, &[]).unwrap_or_else(|error| panic!("{error}"));
    let stop = AtomicBool::new(false);
    let options = RunOptions {
        dir: dir.join(name),
        stop: &stop,
        command_line: vec![HOSTILE.to_owned()],
        fail_fast: false,
        trace: false,
    };
    let log = Rc::new(RefCell::new(Log { broken_method: broken, ..Log::default() }));
    let mut make = || -> Result<Box<dyn Renderer>, RenderFault> { Ok(Box::new(Fake(log.clone()))) };
    run(&plan, &mut make, &options, &mut Quiet).unwrap_or_else(|error| panic!("{error}"));
    options.dir
}

/// The page with the report of a finished run.
fn report(choice: Choice) -> Option<(Page, PathBuf, tempfile::TempDir)> {
    let page = chromium::open()?;
    let dir = tempfile::tempdir().unwrap();
    let run = finished_run(dir.path(), "run", None);
    let written = write(&ReportOptions { images: choice, ..ReportOptions::of_run(&run) }).unwrap();
    Some((page, written.path, dir))
}

/// Rows of errors.csv as (cell, method, samples, alpha, brdf, exposure).
fn rows(report: &Path) -> Vec<[String; 6]> {
    let table = Table::read(&report.with_file_name("errors.csv")).unwrap();
    let columns = ["cell", "method", "samples", "alpha", "brdf", "exposure"].map(|name| table.column(name).unwrap());
    table.rows.iter().map(|row| columns.map(|column| row[column].clone())).collect()
}

fn cell(report: &Path, wanted: [&str; 5]) -> String {
    rows(report).into_iter().find(|row| row[1..] == wanted).unwrap_or_else(|| panic!("no {wanted:?}"))[0].clone()
}

/// The texel that the renderer wrote, as the page must hold it.
fn stored(report: &Path, cell: &str, x: u32, y: u32) -> [f32; 3] {
    let table = Table::read(&report.with_file_name("images.csv")).unwrap();
    let row = table.rows.iter().find(|row| row[table.column("cell").unwrap()] == cell).unwrap();
    let file = &row[table.column("radiance").unwrap()];
    let image = exr::read(&report.with_file_name("images").join(file)).unwrap();
    image.rgb.get(x, y).map(|value| f16::from_f32(value).to_f32())
}

/// Bytes of the canvas where a texel is drawn, read in the same task as a redraw.
fn drawn(page: &mut Page, x: u32, y: u32) -> Vec<u64> {
    let script = format!(
        "(() => {{ const c = document.querySelector('.viewer-stage canvas'), gl = c.getContext('webgl2'); \
         const ev = document.getElementById('exposure'); ev.dispatchEvent(new Event('input')); \
         const scale = Math.floor(Math.min(c.width, c.height) / {SIDE}); \
         const px = Math.round(c.width / 2 + ({x} + 0.5 - {SIDE} / 2) * scale), \
               py = Math.round(c.height / 2 + ({y} + 0.5 - {SIDE} / 2) * scale), out = new Uint8Array(4); \
         gl.readPixels(px, c.height - 1 - py, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, out); return [...out].slice(0, 3); }})()"
    );
    page.eval(&script).as_array().unwrap().iter().map(|byte| byte.as_u64().unwrap()).collect()
}

fn open_compare(page: &mut Page, report: &Path, cell: &str) {
    page.resize(1200, 800, "light");
    page.go(report, &format!("#compare?cell={cell}"));
    page.wait("document.querySelector('.viewer-stage canvas').dataset.ready !== undefined");
}

fn shown(page: &mut Page) -> String {
    page.eval("document.querySelector('.viewer-stage canvas').dataset.shown").as_str().unwrap().to_owned()
}

fn assert_clean(page: &Page) {
    assert!(page.errors.is_empty(), "{:#?}", page.errors);
    let foreign: Vec<&String> = page
        .requests
        .iter()
        .filter(|url| !["file:", "data:", "blob:", "about:"].iter().any(|s| url.starts_with(s)))
        .collect();
    assert!(foreign.is_empty(), "the page asked for {foreign:?}");
}

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
fn keys_flip_in_place_and_space_holds_the_reference() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    let of = |method: &str, samples: &str| cell(&report, [method, samples, "0.1", "ggx", "1"]);
    let (first, second, split) = (of("sampled", "1"), of("sampled", "4"), of("split-sum", ""));
    open_compare(&mut page, &report, &first);
    assert_eq!(shown(&mut page), first);
    page.key("2");
    assert_eq!(shown(&mut page), second);
    page.key("4");
    assert_eq!(shown(&mut page), split);
    page.press(" ");
    assert_eq!(shown(&mut page), "reference");
    // The score is that of the image, not of what judges it.
    let label = "document.querySelector('.viewer-stage canvas').getAttribute('aria-label')";
    let spoken = page.eval(label);
    assert!(spoken.as_str().is_some_and(|text| text.contains("reference") && !text.contains("relMSE")), "{spoken}");
    page.release(" ");
    assert_eq!(shown(&mut page), split);
    page.key("ArrowLeft");
    assert_eq!(shown(&mut page), of("sampled", "16"));
    page.key("e");
    assert_eq!(page.eval("document.querySelector('.viewer-stage canvas').dataset.mode"), json!("error"));
    assert_eq!(page.eval("document.querySelectorAll('.ramp-ticks span').length"), json!(4));
    // No tone curve reaches an error.
    let disabled =
        "[...document.querySelectorAll('#exposure, #contrast, [aria-label=Tone] button')].map((e) => e.disabled)";
    assert_eq!(page.eval(disabled), json!([true, true, true, true]));
    page.key("e");
    assert_eq!(page.eval(disabled), json!([false, false, false, false]));
    page.key("e");
    let flip = page.eval(
        "(() => { const canvas = document.querySelector('.viewer-stage canvas'), gl = canvas.getContext('webgl2'); \
         const times = []; for (let i = 0; i < 20; i++) { const start = performance.now(); \
         document.body.dispatchEvent(new KeyboardEvent('keydown', { key: String(1 + i % 4), bubbles: true })); \
         gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4)); times.push(performance.now() - start); } \
         return times.sort((a, b) => a - b)[10]; })()",
    );
    println!("flip: {flip} ms in the median");
    assert!(flip.as_f64().unwrap() < 250.0, "{flip} ms");
    assert_clean(&page);
}

#[test]
fn pixels_are_the_renderers_exactly() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    let id = cell(&report, ["split-sum", "", "0.1", "ggx", "1"]);
    open_compare(&mut page, &report, &id);
    let (x, y) = (9, 14);
    let truth = stored(&report, &id, x, y);
    // The page's shader includes the renderer's tone curve; one code of rounding is left to the device.
    let near = |drawn: Vec<u64>, wanted: [u8; 3]| drawn.iter().zip(wanted).all(|(a, b)| a.abs_diff(u64::from(b)) <= 1);
    let curve = |exposure: f32, contrast: f32| ToneCurve { exposure, contrast }.apply_rgb8(truth);
    let bytes = drawn(&mut page, x, y);
    assert!(near(bytes.clone(), curve(1.0, 1.0)), "{bytes:?} {:?}", curve(1.0, 1.0));
    let slide = |page: &mut Page, id: &str, value: f32| {
        page.eval(&format!("(() => {{ const e = document.getElementById('{id}'); e.value = {value}; e.dispatchEvent(new Event('input')); }})()"));
    };
    slide(&mut page, "exposure", 2.0);
    slide(&mut page, "contrast", 2.0);
    let bytes = drawn(&mut page, x, y);
    assert!(near(bytes.clone(), curve(4.0, 2.0)), "{bytes:?} {:?}", curve(4.0, 2.0));

    // The probe, at the texel's centre on the screen.
    let place = page.eval(&format!(
        "(() => {{ const c = document.querySelector('.viewer-stage canvas'), b = c.getBoundingClientRect(); \
         const s = Math.floor(Math.min(c.width, c.height) / {SIDE}); \
         return [b.left + b.width / 2 + ({x} + 0.5 - {SIDE} / 2) * s, b.top + b.height / 2 + ({y} + 0.5 - {SIDE} / 2) * s]; }})()"
    ));
    page.click_at(place[0].as_f64().unwrap(), place[1].as_f64().unwrap());
    page.wait(&format!("document.querySelector('.probe h2').textContent.includes('({x}, {y}) · pinned')"));
    let probed = |page: &mut Page, key: &str| {
        let script = format!(
            "[...document.querySelectorAll('[data-probe=\"{key}\"] td')].map((td) => Number(td.dataset.value))"
        );
        page.eval(&script).as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect::<Vec<f64>>()
    };
    let values = probed(&mut page, &id);
    assert_eq!(&values[..3], truth.map(f64::from).as_slice());
    let reference_key = page.eval("document.querySelector('[data-probe^=reference]').dataset.probe");
    let reference = probed(&mut page, reference_key.as_str().unwrap());
    let squares = (0..3).map(|c| (values[c] - reference[c]).powi(2) / (reference[c].powi(2) + 1e-2));
    let error = (squares.sum::<f64>() / 3.0).sqrt();
    assert!(
        (values[3] - error).abs() < 1e-12 && (error - f64::from(SPLIT_SUM_ERROR)).abs() < 0.02,
        "{values:?} {error}"
    );
    assert_clean(&page);
}

#[test]
fn the_error_map_has_the_projects_colours() {
    use splitsum::table::colormap::RELATIVE_ERROR;
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    let id = cell(&report, ["sampled", "4", "0.5", "ggx", "1"]);
    open_compare(&mut page, &report, &id);
    page.key("e");
    let (x, y) = (12, 12);
    let [test, reference] = [stored(&report, &id, x, y).map(f64::from), {
        let factor = 1.0 + f64::from(ERROR_AT_ONE) / 2.0;
        stored(&report, &id, x, y).map(|value| f64::from(f16::from_f64(f64::from(value) / factor)))
    }];
    let squares = (0..3).map(|c| (test[c] - reference[c]).powi(2) / (reference[c].powi(2) + 1e-2));
    let wanted = RELATIVE_ERROR.color((squares.sum::<f64>() / 3.0).sqrt());
    let bytes = drawn(&mut page, x, y);
    assert!(bytes.iter().zip(wanted).all(|(a, b)| a.abs_diff(u64::from(b)) <= 2), "{bytes:?} {wanted:?}");
    let off = drawn(&mut page, 0, 0);
    assert_eq!(off, splitsum::table::colormap::OFF_MASK_COLOR.map(u64::from));
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
fn a_link_restores_what_was_seen() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    let id = cell(&report, ["sampled", "1", "0.1", "ggx", "1"]);
    open_compare(&mut page, &report, &id);
    for key in ["3", "]", "]", "e", "d", "+", "+", "c"] {
        page.key(key);
    }
    page.wait("location.hash.includes('clip=1')");
    let hash = page.eval("location.hash").as_str().unwrap().to_owned();
    let state = "(() => { const c = document.querySelector('.viewer-stage canvas'); return [c.dataset.shown, c.dataset.mode, \
                 document.querySelector('.scale-text').textContent, document.querySelector('.split-handle').style.left, \
                 document.getElementById('exposure').value, document.querySelector('.checks input').checked]; })()";
    let before = page.eval(state);
    page.go(&report, &hash);
    page.wait("document.querySelector('.viewer-stage canvas').dataset.ready !== undefined");
    assert_eq!(page.eval(state), before);
    assert_eq!(before[0], json!(cell(&report, ["sampled", "16", "0.1", "ggx", "1"])));
    assert_eq!(before[4], json!("1"));
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
