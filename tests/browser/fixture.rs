//! A synthetic finished run, with names that would run as code if the page did not escape them, and
//! its report in a browser.

use crate::chromium::{self, Page};
use crate::fake::{Log, Silent, fakes};
use half::f16;
use serde_json::json;
use splitsum::base::csv::Table;
use splitsum::base::pixels::exr;
use splitsum::experiment::Plan;
use splitsum::report::COMPANIONS;
use splitsum::report::page::images::Choice;
use splitsum::report::page::{PageOptions, PageRun, write};
use splitsum::run::{RunOptions, run};
use splitsum::study::finished::Finished;
use splitsum::study::questions::{Answer, answers};
use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::atomic::AtomicBool;

/// A name that would run as code, close elements or start a formula if it were not escaped.
pub const HOSTILE: &str = r#"=1+1, "quoted"
</script><script>window.pwned = 1</script><img src=x onerror='window.pwned = 2'> {{ 7 * 7 }}"#;
/// The same for a folder, whose name becomes a label and part of links.
pub const HOSTILE_FOLDER: &str = r#"le'ft "<b>#1?%41"#;
pub const SIDE: u32 = 24;

/// A synthetic finished run of the renderer; the folder's name is hostile too.
pub fn finished_run(dir: &Path, name: &str, broken: Option<&'static str>) -> PathBuf {
    let axes = "environment = [\"builtin:constant\"]\nbrdf = [\"ggx\", \"phong\"]\nalpha = [0.1, \
                0.5]\n\
                method = [\"sampled\", \"split-sum\"]\nsamples = [1, 4, 16]\nexposure = [1, 10]";
    let why = json!("phong has \"<b>no</b>\" alpha of 0.5 & </script>");
    let rest = format!(
        "[[exclude]]\nbrdf = \"phong\"\nalpha = 0.5\nwhy = {why}\n[timing]\nwarmup = 1\nrounds = 3"
    );
    run_of(
        &dir.join(name),
        axes,
        &rest,
        Log {
            broken_method: broken,
            ..Log::default()
        },
    )
}

pub fn report_of(dir: &Path, axes: &str, rest: &str) -> PathBuf {
    page_of(
        &run_of(&dir.join("run"), axes, rest, Log::default()),
        Choice::Automatic,
    )
}

pub fn run_of(dir: &Path, axes: &str, rest: &str, log: Log) -> PathBuf {
    let question = json!(HOSTILE);
    let head = format!(
        "name = \"hostile\"\nquestion = {question}\nsize = [{SIDE}, {SIDE}]\nreference = {{ \
         samples = 64, noise_share = 0 }}"
    );
    let (file, text) = (
        dir.with_file_name("hostile.toml"),
        format!("{head}\n[axes]\n{axes}\n{rest}\n"),
    );
    let plan = Plan::from_text(&file, &text, &[]).unwrap_or_else(|error| panic!("{error}"));
    let stop = AtomicBool::new(false);
    let fail_fast = log.broken.is_none() && log.broken_method.is_none();
    let options = RunOptions {
        fail_fast,
        command_line: vec![HOSTILE.to_owned()],
        companions: COMPANIONS,
        ..RunOptions::new(dir, &stop)
    };
    let log = Rc::new(RefCell::new(log));
    run(&plan, &mut fakes(&log), &options, &mut Silent).unwrap_or_else(|error| panic!("{error}"));
    options.dir
}

/// Writes the report of finished runs with their answers.
pub fn write_page(dirs: &[PathBuf], options: &PageOptions) -> PathBuf {
    let answered = |dir: &PathBuf| -> (Finished, Vec<Answer>) {
        let run = Finished::read(dir).unwrap_or_else(|error| panic!("{error}"));
        let answers = answers(&run, None);
        (run, answers)
    };
    let runs: Vec<_> = dirs.iter().map(answered).collect();
    write(options, &PageRun::of_runs(&runs))
        .unwrap_or_else(|error| panic!("{error}"))
        .path
}

/// Writes the report of a finished run into its folder.
pub fn page_of(run: &Path, images: Choice) -> PathBuf {
    write_page(
        &[run.to_owned()],
        &PageOptions {
            images,
            ..PageOptions::in_folder(run)
        },
    )
}

pub fn report(choice: Choice) -> Option<(Page, PathBuf, tempfile::TempDir)> {
    let page = chromium::open()?;
    let dir = tempfile::tempdir().unwrap();
    let run = finished_run(dir.path(), "run", None);
    let path = page_of(&run, choice);
    Some((page, path, dir))
}

/// The cell of this method, samples, alpha, brdf and exposure in errors.csv.
pub fn cell(report: &Path, wanted: [&str; 5]) -> String {
    let table = Table::read(&report.with_file_name("errors.csv")).unwrap();
    let columns =
        ["method", "samples", "alpha", "brdf", "exposure"].map(|name| table.column(name).unwrap());
    let is_wanted = |row: &&Vec<String>| columns.map(|column| row[column].as_str()) == wanted;
    let row = table
        .rows
        .iter()
        .find(is_wanted)
        .unwrap_or_else(|| panic!("no {wanted:?}"));
    row[table.column("cell").unwrap()].clone()
}

/// The texel that the renderer wrote, in the encoding of the page.
pub fn stored(report: &Path, cell: &str, x: u32, y: u32) -> [f32; 3] {
    let table = Table::read(&report.with_file_name("images.csv")).unwrap();
    let row = table
        .rows
        .iter()
        .find(|row| row[table.column("cell").unwrap()] == cell)
        .unwrap();
    let file = &row[table.column("radiance").unwrap()];
    let image = exr::read(&report.with_file_name("images").join(file)).unwrap();
    image
        .rgb
        .get(x, y)
        .map(|value| f16::from_f32(value).to_f32())
}

pub fn assert_clean(page: &Page) {
    assert!(page.errors.is_empty(), "{:#?}", page.errors);
    let foreign: Vec<&String> = page
        .requests
        .iter()
        .filter(|url| {
            !["file:", "data:", "blob:", "about:"]
                .iter()
                .any(|s| url.starts_with(s))
        })
        .collect();
    assert!(foreign.is_empty(), "the page asked for {foreign:?}");
}
