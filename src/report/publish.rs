//! Published runs: the small files of finished runs in a folder for git, and a page with the answers of all of them.

use super::record::{ANSWER_FILE, AnswerRecord, WriteError};
use super::summary::{SHEETS_FOLDER, bold, sheet_link, sheet_title};
use super::write::SUMMARY_FILE;
use crate::files::{TEXT_BYTES_MAX, names_in, read_text, relative};
use crate::pixels::{PixelsError, png, write_atomically};
use crate::run::frozen::EXPERIMENT_FILE;
use crate::run::provenance::{EXPERIMENT_FOLDER, PROVENANCE_FILE, SET_FOLDER};
use crate::run::sheets::draw::PUBLISHED_SIZE;
use crate::run::sheets::sheet_files;
use crate::run::store::{ANSWERS_FOLDER, TIMINGS_FOLDER};
use crate::study::finished::{FinishedError, provenance};
use crate::table::markdown::{self, Align, MarkdownTable, inline, link_label, paragraph};
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Files of a run that are published beside its answers and the raw samples of its timings.
const FILES: [&str; 7] =
    [EXPERIMENT_FILE, "environments.csv", "errors.csv", "steps.csv", "timings.csv", "timing_ratios.csv", SUMMARY_FILE];
/// A larger file or folder is left out: the folder is kept in git.
const BYTES_MAX: u64 = 1 << 20;
/// A larger contact sheet is shrunk further, bytes.
const SHEET_BYTES_MAX: usize = 300_000;
/// What the user adds to the published folder of a run: kept, and read into the page.
const REMARK_FILE: &str = "remark.md";
/// The page over all runs.
const PAGE: &str = "README.md";

/// Why a run could not be published.
#[derive(Debug, thiserror::Error)]
pub enum PublishError {
    #[error(transparent)]
    Answers(#[from] WriteError),
    #[error(transparent)]
    Run(#[from] FinishedError),
    #[error(transparent)]
    File(#[from] PixelsError),
    #[error("{}: {error}", path.display())]
    Io { path: PathBuf, error: std::io::Error },
    /// The user named a wrong folder, or a page has a wrong block.
    #[error("{0}")]
    Misuse(String),
}

impl PublishError {
    /// Whether the user is at fault, rather than a file.
    pub fn is_misuse(&self) -> bool {
        matches!(self, Self::Misuse(_) | Self::Run(_))
    }
}

fn misuse<T>(path: &Path, what: &str) -> Result<T, PublishError> {
    Err(PublishError::Misuse(format!("{}: {what}", path.display())))
}

fn io(path: &Path) -> impl Fn(std::io::Error) -> PublishError + '_ {
    move |error| PublishError::Io { path: path.to_owned(), error }
}

fn make_folder(path: &Path) -> Result<(), PublishError> {
    let expected = "choose a folder in which you may write";
    std::fs::create_dir_all(path).or_else(|error| misuse(path, &format!("cannot be made ({error}): {expected}")))
}

/// Fails if publishing the run in `dir` into a folder would replace something else: the run of another plan, unless `replace`, or files
/// that were never published.
pub fn check(dir: &Path, into: &Path, replace: bool) -> Result<(), PublishError> {
    let new = provenance(dir)?;
    let target = into.join(new["name"].as_str().unwrap_or_default());
    if let Some(file) = [into, &target].into_iter().find(|path| path.is_file()) {
        return misuse(file, "is a file; expected a folder of published runs, or the name of one to make");
    }
    let whole = |path: &Path| std::fs::canonicalize(path).ok();
    if whole(dir).is_some_and(|dir| Some(dir) == whole(&target)) {
        return misuse(&target, "is the folder of the run itself; expected another one to publish into");
    }
    if files_in(&target).is_empty() {
        return Ok(());
    }
    if !target.join(ANSWERS_FOLDER).join(ANSWER_FILE).exists() {
        return misuse(&target, "holds files but no published run; expected a folder of published runs");
    }
    let published = provenance(&target)?;
    if replace || published["plan_hash"] == new["plan_hash"] {
        return Ok(());
    }
    let words = |provenance: &serde_json::Value| {
        let date = provenance["sessions"].as_array().and_then(|sessions| sessions.last()?["date_utc"].as_str());
        format!("{} of {}", provenance["plan_hash"].as_str().unwrap_or("unknown"), date.unwrap_or("an unknown date"))
    };
    let (published, new) = (words(&published), words(&new));
    let what = format!(
        "holds the published run of plan {published}, and {} is one of plan {new}; give --replace to replace it",
        dir.display()
    );
    misuse(&target, &what)
}

/// Files of a folder that are not the user's remark.
fn files_in(folder: &Path) -> Vec<PathBuf> {
    let paths = names_in(folder).into_iter().filter(|name| name != REMARK_FILE).map(|name| folder.join(name));
    paths.filter(|path| path.is_file()).collect()
}

/// Copies what is small of the run in `dir`, which has its answers, to `into/NAME`, in the place of the published run of another plan only
/// if `replace` says so ([`check`]). Returns what was left out, one sentence each.
pub fn publish(dir: &Path, into: &Path, replace: bool) -> Result<Vec<String>, PublishError> {
    check(dir, into, replace)?;
    let record = AnswerRecord::read(dir)?;
    let target = into.join(&record.name);
    for folder in ["", ANSWERS_FOLDER, TIMINGS_FOLDER].map(|name| target.join(name)) {
        // Files of an earlier publication that this one does not have.
        files_in(&folder).iter().try_for_each(|path| std::fs::remove_file(path).map_err(io(path)))?;
    }
    let answers = record.files.iter().map(String::as_str).chain([ANSWER_FILE]);
    let answers = answers.map(|name| format!("{ANSWERS_FOLDER}/{name}"));
    let mut units: Vec<(String, Vec<PathBuf>)> = FILES
        .iter()
        .map(|name| (*name).to_owned())
        .chain(answers)
        .map(|name| (name.clone(), vec![dir.join(name)]))
        .collect();
    units.push((TIMINGS_FOLDER.to_owned(), files_in(&dir.join(TIMINGS_FOLDER))));
    let mut left_out: Vec<String> = Vec::new();
    for (name, files) in units {
        let bytes: u64 = files.iter().filter_map(|path| Some(std::fs::metadata(path).ok()?.len())).sum();
        if bytes > BYTES_MAX {
            left_out.push(format!("{name} ({:.1} MB)", bytes as f64 / 1e6));
            continue;
        }
        for from in files.iter().filter(|path| path.is_file()) {
            let to = target.join(from.strip_prefix(dir).unwrap_or(from));
            make_folder(to.parent().unwrap_or(&target))?;
            std::fs::copy(from, to).map_err(io(from))?;
        }
    }
    write_provenance(dir, &target)?;
    let summary = target.join(SUMMARY_FILE);
    let mut text = read_text(&summary, TEXT_BYTES_MAX).map_err(io(&summary))?;
    // The first page: the one that the summary shows.
    if let Some(sheet) = sheet_files(dir).first() {
        let name = sheet.file_name().map_or_else(|| "sheet.png".into(), |name| name.to_string_lossy());
        let link = sheet_link(&name);
        if text.contains(&link) {
            publish_sheet(sheet, &target.join(&*name))?;
            text = text.replace(&link, &markdown::link(sheet_title(&name), &name));
            text = text.replace(&markdown::link(SHEETS_FOLDER, SHEETS_FOLDER), &link_label(SHEETS_FOLDER));
        }
    }
    if !left_out.is_empty() {
        text += &format!("\nToo large to be published: {}. Run the experiment to get them.\n", left_out.join(", "));
    }
    write_atomically(&summary, |writer| writer.write_all(text.as_bytes()))?;
    Ok(left_out.iter().map(|name| format!("{}: left out {name}", dir.display())).collect())
}

/// Writes a contact sheet smaller.
fn publish_sheet(from: &Path, to: &Path) -> Result<(), PublishError> {
    let image = png::read_rgb8(from)?;
    let [width, height] = [image.width, image.height].map(f64::from);
    let [width_max, height_max] = PUBLISHED_SIZE.map(f64::from);
    let mut factor = (width_max / width).min(height_max / height).min(1.0);
    loop {
        let [width, height] = [width, height].map(|side| (side * factor).floor().max(1.0) as u32);
        let bytes = png::encode_rgb8(&image.shrunk(width, height)).map_err(io(from))?;
        if bytes.len() <= SHEET_BYTES_MAX || width.min(height) == 1 {
            return Ok(write_atomically(to, |writer| writer.write_all(&bytes))?);
        }
        // Noise does not compress.
        factor *= 7.0 / 8.0;
    }
}

/// The provenance, with the folders of the experiment's files as they are reached from the published one.
fn write_provenance(dir: &Path, target: &Path) -> Result<(), PublishError> {
    let mut value = provenance(dir)?;
    for key in [EXPERIMENT_FOLDER, SET_FOLDER] {
        if let Some(folder) = value[key].as_str() {
            value[key] = relative(target, &dir.join(folder)).into();
        }
    }
    let text = format!("{value:#}\n");
    Ok(write_atomically(&target.join(PROVENANCE_FILE), |writer| writer.write_all(text.as_bytes()))?)
}

/// Writes `README.md` of a folder of published runs: the answers of all of them. Returns its path.
pub fn write_page(into: &Path) -> Result<PathBuf, PublishError> {
    let mut folders: Vec<String> = std::fs::read_dir(into)
        .map_err(io(into))?
        .flatten()
        .filter(|entry| entry.path().join(ANSWERS_FOLDER).join(ANSWER_FILE).exists())
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    folders.sort();
    let runs = folders.into_iter().map(|folder| Ok((AnswerRecord::read(&into.join(&folder))?, folder)));
    let runs: Vec<(AnswerRecord, String)> = runs.collect::<Result<_, PublishError>>()?;
    let mut table = MarkdownTable::new(&[("run", Align::Left), ("question", Align::Left), ("answer", Align::Left)]);
    for (run, folder) in &runs {
        let link = markdown::link(&run.name, &format!("{folder}/{SUMMARY_FILE}"));
        table.row_with_link(&link, &[run.question.as_str(), run.headline()]);
    }
    let mut text = format!(
        "# Published runs\n\n`splitsum answers --publish` writes this page. The remarks are the user's (`NAME/{REMARK_FILE}`).\n\n{table}\n"
    );
    if runs.iter().any(|(run, _)| run.is_cpu_timed) {
        text += "**Times from a CPU driver say nothing about a GPU.** Errors do not depend on the device's speed.\n\n";
    }
    for (run, folder) in &runs {
        text += &section(run, folder, &into.join(folder));
    }
    let path = into.join(PAGE);
    write_atomically(&path, |writer| writeln!(writer, "{}", text.trim_end()))?;
    Ok(path)
}

/// The section of a run in the page, whose folder is `folder` beside the page.
fn section(run: &AnswerRecord, folder: &str, dir: &Path) -> String {
    let mut text = format!("## {}\n\n{}\n\n{}\n\n", inline(&run.name), paragraph(&run.question), bold(run.headline()));
    text.extend(run.answers.iter().skip(1).map(|answer| format!("- {}\n", paragraph(&answer.sentence))));
    let remark = read_text(&dir.join(REMARK_FILE), TEXT_BYTES_MAX).unwrap_or_default();
    if !remark.trim().is_empty() {
        text += &format!("\n{}\n", remark.trim());
    }
    let figures = run.files.iter().filter_map(|name| name.strip_suffix(".svg"));
    let figures = figures.map(|name| format!("[{name}]({folder}/{ANSWERS_FOLDER}/{name}.svg)"));
    let sheet = names_in(dir).into_iter().filter(|name| name.ends_with(".png")).min();
    let sheet = sheet.map(|sheet| markdown::link("contact sheet", &format!("{folder}/{sheet}")));
    let links = figures.chain(sheet).chain([format!("[all numbers]({folder}/{SUMMARY_FILE})")]);
    let failed = if run.failed > 0 { format!(", {} failed", run.failed) } else { String::new() };
    let commit = run.commit.get(..12).map_or_else(String::new, |commit| format!(", commit {commit}"));
    text += &format!(
        "\n{}\n\n{} cells{failed} on {}{}, {}{commit}.\n\n",
        links.collect::<Vec<_>>().join(" · "),
        run.cells,
        inline(&run.devices.join("; ")),
        if run.is_cpu_timed { " (CPU)" } else { "" },
        run.date_utc
    );
    text
}
