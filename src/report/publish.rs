//! Publishes runs: copies their small files into a folder for git, with a page of all answers.

use super::page::PageError;
use super::record::{ANSWER_FILE, AnswerRecord, WriteError};
use super::summary::{SHEETS_FOLDER, bold, sheet_link, sheet_title};
use super::write::SUMMARY_FILE;
use crate::base::files::{TEXT_BYTES_MAX, names_in, read_text, relative};
use crate::base::pixels::{PixelsError, write_atomically};
use crate::draw::markdown::{self, Align, MarkdownTable, inline, link_label, paragraph};
use crate::run::frozen::EXPERIMENT_FILE;
use crate::run::provenance::PROVENANCE_FILE;
use crate::run::sheets::sheet_files;
use crate::run::store::{ANSWERS_FOLDER, TIMINGS_FOLDER};
use crate::study::finished::{FinishedError, provenance};
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Published files besides the answers and the timing records.
const FILES: [&str; 6] = [
    EXPERIMENT_FILE,
    "environments.csv",
    "errors.csv",
    "steps.csv",
    "timings.csv",
    SUMMARY_FILE,
];
/// Larger files and folders are omitted.
const BYTES_MAX: u64 = 1 << 20;
/// The user's remark on a published run, copied into the page.
const REMARK_FILE: &str = "remark.md";
pub const PAGE: &str = "README.md";

#[derive(Debug, thiserror::Error)]
pub enum PublishError {
    #[error(transparent)]
    Answers(#[from] WriteError),
    #[error(transparent)]
    Run(#[from] FinishedError),
    #[error(transparent)]
    File(#[from] PixelsError),
    #[error(transparent)]
    Report(#[from] PageError),
    #[error("{}: {error}", path.display())]
    Io {
        path: PathBuf,
        error: std::io::Error,
    },
    /// A wrong folder or a wrong block in a page.
    #[error("{0}")]
    Misuse(String),
}

impl PublishError {
    pub fn is_misuse(&self) -> bool {
        matches!(self, Self::Misuse(_) | Self::Run(_))
            || matches!(self, Self::Report(fault) if fault.is_misuse())
    }
}

pub(super) fn misuse<T>(path: &Path, what: &str) -> Result<T, PublishError> {
    Err(PublishError::Misuse(format!("{}: {what}", path.display())))
}

pub(super) fn io(path: &Path) -> impl Fn(std::io::Error) -> PublishError + '_ {
    move |error| PublishError::Io {
        path: path.to_owned(),
        error,
    }
}

pub(super) fn make_folder(path: &Path) -> Result<(), PublishError> {
    std::fs::create_dir_all(path).or_else(|error| {
        misuse(
            path,
            &format!("cannot create the folder: {error}; choose another one"),
        )
    })
}

/// Fails if publishing the run in `dir` would replace the run of another plan, unless `replace`, or
/// files that were never published.
pub fn check(dir: &Path, into: &Path, replace: bool) -> Result<(), PublishError> {
    let new = provenance(dir)?;
    let target = into.join(&new.name);
    if let Some(file) = [into, &target].into_iter().find(|path| path.is_file()) {
        return misuse(
            file,
            "is a file; expected a folder of published runs, or the name of a new one",
        );
    }
    let whole = |path: &Path| std::fs::canonicalize(path).ok();
    if whole(dir).is_some_and(|dir| Some(dir) == whole(&target)) {
        return misuse(
            &target,
            "is the folder of the run itself; choose another one",
        );
    }
    if files_in(&target).is_empty() {
        return Ok(());
    }
    if !target.join(ANSWERS_FOLDER).join(ANSWER_FILE).exists() {
        return misuse(
            &target,
            "contains files but no published run; expected a folder of published runs",
        );
    }
    let published = provenance(&target)?;
    if replace || published.plan_hash == new.plan_hash {
        return Ok(());
    }
    let what = format!(
        "contains a published run of another plan than {}; give --replace to replace it",
        dir.display()
    );
    misuse(&target, &what)
}

/// Files of a folder, without the user's remark.
fn files_in(folder: &Path) -> Vec<PathBuf> {
    let paths = names_in(folder)
        .into_iter()
        .filter(|name| name != REMARK_FILE)
        .map(|name| folder.join(name));
    paths.filter(|path| path.is_file()).collect()
}

/// Copies the small files of the run in `dir`, which has answers, to `into/NAME`, if [`check`]
/// allows it. Returns the omitted files.
pub fn publish(dir: &Path, into: &Path, replace: bool) -> Result<Vec<String>, PublishError> {
    check(dir, into, replace)?;
    let record = AnswerRecord::read(dir)?;
    let target = into.join(&record.name);
    for folder in ["", ANSWERS_FOLDER, TIMINGS_FOLDER].map(|name| target.join(name)) {
        // Files of an earlier publication.
        files_in(&folder)
            .iter()
            .try_for_each(|path| std::fs::remove_file(path).map_err(io(path)))?;
    }
    let answers = record.files.iter().map(String::as_str).chain([ANSWER_FILE]);
    let answers = answers.map(|name| format!("{ANSWERS_FOLDER}/{name}"));
    let mut units: Vec<(String, Vec<PathBuf>)> = FILES
        .iter()
        .map(|name| (*name).to_owned())
        .chain(answers)
        .map(|name| (name.clone(), vec![dir.join(name)]))
        .collect();
    units.push((
        TIMINGS_FOLDER.to_owned(),
        files_in(&dir.join(TIMINGS_FOLDER)),
    ));
    let mut left_out: Vec<String> = Vec::new();
    for (name, files) in units {
        let bytes: u64 = files
            .iter()
            .filter_map(|path| Some(std::fs::metadata(path).ok()?.len()))
            .sum();
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
    // The sheet that the summary shows.
    if let Some(sheet) = sheet_files(dir).first() {
        let name = sheet
            .file_name()
            .map_or_else(|| "sheet.svg".into(), |name| name.to_string_lossy());
        let link = sheet_link(&name);
        if text.contains(&link) {
            std::fs::copy(sheet, target.join(&*name)).map_err(io(sheet))?;
            text = text.replace(&link, &markdown::link(sheet_title(&name), &name));
            text = text.replace(
                &markdown::link(SHEETS_FOLDER, SHEETS_FOLDER),
                &link_label(SHEETS_FOLDER),
            );
        }
    }
    if !left_out.is_empty() {
        text += &format!(
            "\nToo large to be published: {}. Run the experiment to get them.\n",
            left_out.join(", ")
        );
    }
    write_atomically(&summary, |writer| writer.write_all(text.as_bytes()))?;
    Ok(left_out
        .iter()
        .map(|name| format!("{}: omitted {name}", dir.display()))
        .collect())
}

/// Writes the provenance, with folders relative to the published one.
fn write_provenance(dir: &Path, target: &Path) -> Result<(), PublishError> {
    let mut published = provenance(dir)?;
    let folders = [&mut published.experiment_folder, &mut published.set_folder];
    for folder in folders.into_iter().flatten() {
        *folder = relative(target, &dir.join(&*folder));
    }
    let text = format!("{:#}\n", published.to_json());
    Ok(write_atomically(&target.join(PROVENANCE_FILE), |writer| {
        writer.write_all(text.as_bytes())
    })?)
}

/// The published runs in a folder, with the names of their folders, sorted.
pub(super) fn published(into: &Path) -> Result<Vec<(AnswerRecord, String)>, PublishError> {
    let mut folders: Vec<String> = std::fs::read_dir(into)
        .map_err(io(into))?
        .flatten()
        .filter(|entry| entry.path().join(ANSWERS_FOLDER).join(ANSWER_FILE).exists())
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    folders.sort();
    folders
        .into_iter()
        .map(|folder| Ok((AnswerRecord::read(&into.join(&folder))?, folder)))
        .collect()
}

/// Writes `README.md` with the answers of all published runs. Returns its path.
pub fn write_page(into: &Path) -> Result<PathBuf, PublishError> {
    let runs = published(into)?;
    let mut table = MarkdownTable::new(&[
        ("run", Align::Left),
        ("question", Align::Left),
        ("answer", Align::Left),
    ]);
    for (run, folder) in &runs {
        let link = markdown::link(&run.name, &format!("{folder}/{SUMMARY_FILE}"));
        table.row_with_link(&link, &[run.question.as_str(), run.headline()]);
    }
    let mut text = format!(
        "# Published runs\n\n`splitsum answers --publish` writes this page. Remarks come from \
         `NAME/{REMARK_FILE}`.\n\n{table}\n"
    );
    if runs.iter().any(|(run, _)| run.is_cpu_timed) {
        text += "**Times from a CPU driver say nothing about a GPU.** Errors do not depend on the \
                 device's speed.\n\n";
    }
    for (run, folder) in &runs {
        text += &section(run, folder, &into.join(folder));
    }
    let path = into.join(PAGE);
    write_atomically(&path, |writer| writeln!(writer, "{}", text.trim_end()))?;
    Ok(path)
}

fn section(run: &AnswerRecord, folder: &str, dir: &Path) -> String {
    let mut text = format!(
        "## {}\n\n{}\n\n{}\n\n",
        inline(&run.name),
        paragraph(&run.question),
        bold(run.headline())
    );
    text.extend(
        run.answers
            .iter()
            .skip(1)
            .map(|answer| format!("- {}\n", paragraph(&answer.sentence))),
    );
    let remark = read_text(&dir.join(REMARK_FILE), TEXT_BYTES_MAX).unwrap_or_default();
    if !remark.trim().is_empty() {
        text += &format!("\n{}\n", remark.trim());
    }
    let figures = run
        .files
        .iter()
        .filter_map(|name| name.strip_suffix(".svg"));
    let figures = figures.map(|name| format!("[{name}]({folder}/{ANSWERS_FOLDER}/{name}.svg)"));
    let sheet = names_in(dir)
        .into_iter()
        .filter(|name| name.ends_with(".svg"))
        .min();
    let sheet = sheet.map(|sheet| markdown::link("contact sheet", &format!("{folder}/{sheet}")));
    let links = figures
        .chain(sheet)
        .chain([format!("[all numbers]({folder}/{SUMMARY_FILE})")]);
    let failed = if run.failed > 0 {
        format!(", {} failed", run.failed)
    } else {
        String::new()
    };
    let commit = run
        .commit
        .get(..12)
        .map_or_else(String::new, |commit| format!(", commit {commit}"));
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
