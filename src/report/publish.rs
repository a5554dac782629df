//! Publishes runs: copies their small files into a folder for git, with a page of all answers.

use super::page::PageError;
use super::record::{ANSWER_FILE, AnswerRecord, WriteError};
use super::sheets::sheet_files;
use super::summary::{with_local_sheet, without_sheet};
use super::write::SUMMARY_FILE;
use crate::base::files::{TEXT_BYTES_MAX, names_in, read_text, relative};
use crate::base::pixels::{PixelsError, write_atomically};
use crate::draw::markdown::{self, Align, MarkdownTable, inline, paragraph};
use crate::run::frozen::EXPERIMENT_FILE;
use crate::run::provenance::PROVENANCE_FILE;
use crate::run::store::{ANSWERS_FOLDER, TIMINGS_FOLDER};
use crate::study::finished::{FinishedError, provenance};
use std::io::Write as _;
use std::path::{Component, Path, PathBuf};

/// Published files besides the answers and the timing records.
const FILES: [&str; 7] = [
    EXPERIMENT_FILE,
    "environments.csv",
    "errors.csv",
    "recovery.csv",
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

/// A file or a folder of files that is published whole or not at all.
struct Unit {
    name: String,
    files: Vec<PathBuf>,
}

impl Unit {
    fn file(dir: &Path, name: impl Into<String>) -> Self {
        let name = name.into();
        let files = vec![dir.join(&name)];
        Self { name, files }
    }

    fn bytes(&self) -> u64 {
        self.files
            .iter()
            .filter_map(|path| Some(std::fs::metadata(path).ok()?.len()))
            .sum()
    }

    /// Copies the files that exist from the folder `dir` to `target`.
    fn copy(&self, dir: &Path, target: &Path) -> Result<(), PublishError> {
        for from in self.files.iter().filter(|path| path.is_file()) {
            let to = target.join(from.strip_prefix(dir).unwrap_or(from));
            make_folder(to.parent().unwrap_or(target))?;
            std::fs::copy(from, to).map_err(io(from))?;
        }
        Ok(())
    }
}

/// The files of a run to publish, besides provenance and contact sheet.
fn units(dir: &Path, record: &AnswerRecord) -> Vec<Unit> {
    let mut units: Vec<Unit> = FILES.iter().map(|name| Unit::file(dir, *name)).collect();
    for name in record.files.iter().map(String::as_str).chain([ANSWER_FILE]) {
        units.push(Unit::file(dir, format!("{ANSWERS_FOLDER}/{name}")));
    }
    units.push(Unit {
        name: TIMINGS_FOLDER.to_owned(),
        files: files_in(&dir.join(TIMINGS_FOLDER)),
    });
    units
}

/// Copies the small files of the run in `dir`, which has answers, to `into/NAME`, if [`check`]
/// allows it. Returns the omitted files.
pub fn publish(dir: &Path, into: &Path, replace: bool) -> Result<Vec<String>, PublishError> {
    check(dir, into, replace)?;
    let record = AnswerRecord::read(dir)?;
    let target = into.join(&record.name);
    remove_published(&target)?;
    let mut left_out: Vec<String> = Vec::new();
    for unit in units(dir, &record) {
        let bytes = unit.bytes();
        if bytes > BYTES_MAX {
            left_out.push(omitted(&unit.name, bytes));
        } else {
            unit.copy(dir, &target)?;
        }
    }
    write_provenance(dir, &target)?;
    write_summary(dir, &target, &mut left_out)?;
    Ok(left_out
        .iter()
        .map(|name| format!("{}: omitted {name}", dir.display()))
        .collect())
}

/// A file that is too large to be published, with its size.
fn omitted(name: &str, bytes: u64) -> String {
    format!("{name} ({:.1} MB)", bytes as f64 / 1e6)
}

/// Removes the files of an earlier publication.
fn remove_published(target: &Path) -> Result<(), PublishError> {
    for folder in ["", ANSWERS_FOLDER, TIMINGS_FOLDER] {
        for path in files_in(&target.join(folder)) {
            std::fs::remove_file(&path).map_err(io(&path))?;
        }
    }
    Ok(())
}

/// Adapts the published summary: the sheet that it shows is beside it, and it names the omitted
/// files. A sheet that is too large is one of them.
fn write_summary(
    dir: &Path,
    target: &Path,
    left_out: &mut Vec<String>,
) -> Result<(), PublishError> {
    let path = target.join(SUMMARY_FILE);
    let mut text = read_text(&path, TEXT_BYTES_MAX).map_err(io(&path))?;
    if let Some(sheet) = sheet_files(dir).first() {
        let name = sheet
            .file_name()
            .map_or_else(|| "sheet.svg".into(), |name| name.to_string_lossy());
        // Only runs with pictures link their sheets.
        if let Some(adapted) = with_local_sheet(&text, &name) {
            let bytes = std::fs::metadata(sheet).map_err(io(sheet))?.len();
            if bytes > BYTES_MAX {
                left_out.push(omitted(&name, bytes));
                text = without_sheet(&text, &name);
            } else {
                std::fs::copy(sheet, target.join(&*name)).map_err(io(sheet))?;
                text = adapted;
            }
        }
    }
    if !left_out.is_empty() {
        text += &format!(
            "\nToo large to be published: {}. Run the experiment to get them.\n",
            left_out.join(", ")
        );
    }
    Ok(write_atomically(&path, |writer| {
        writer.write_all(text.as_bytes())
    })?)
}

/// Writes the provenance, with folders relative to the published one, and without folders that only
/// this machine has.
fn write_provenance(dir: &Path, target: &Path) -> Result<(), PublishError> {
    let mut published = provenance(dir)?;
    for folder in [&mut published.experiment_folder, &mut published.set_folder] {
        *folder = folder
            .take()
            .and_then(|folder| published_folder(target, &dir.join(folder)));
    }
    let sessions = published.sessions.iter_mut();
    for argument in sessions.flat_map(|session| &mut session.command_line) {
        *argument = without_folders(argument);
    }
    let text = format!("{:#}\n", published.to_json());
    Ok(write_atomically(&target.join(PROVENANCE_FILE), |writer| {
        writer.write_all(text.as_bytes())
    })?)
}

/// Returns the way from a published run to a folder; `None` if the folder is elsewhere than in the
/// parent of all published runs or above it, since the way would name folders of this machine.
fn published_folder(target: &Path, folder: &Path) -> Option<String> {
    let parent_of_all = target.join("../..");
    let way = PathBuf::from(relative(&parent_of_all, folder));
    let climbs = way.components().any(|part| part == Component::ParentDir);
    let descends = way
        .components()
        .any(|part| matches!(part, Component::Normal(_)));
    (way.is_relative() && !(climbs && descends)).then(|| relative(target, folder))
}

/// Shortens absolute paths of an argument to the names of their files, also behind `=` and in
/// lists: `--set=environment=/data/a.hdr,b.hdr` becomes `--set=environment=a.hdr,b.hdr`.
fn without_folders(argument: &str) -> String {
    // The colon of `file:`; on Windows, drives have one.
    let is_colon = |c: char| c == ':' && !cfg!(windows);
    let is_separator = |c: char| ['=', ',', '"', '[', ']'].contains(&c) || is_colon(c);
    let parts = argument.split_inclusive(is_separator).map(|part| {
        let end = part.trim_end_matches(is_separator).len();
        let (path, separator) = part.split_at(end);
        let path = Path::new(path);
        match path.file_name().filter(|_| path.is_absolute()) {
            Some(name) => format!("{}{separator}", name.to_string_lossy()),
            None => part.to_owned(),
        }
    });
    parts.collect()
}

/// A published run.
pub(super) struct PublishedRun {
    /// Name of its folder.
    pub folder: String,
    pub record: AnswerRecord,
}

/// The published runs in a folder, by folder.
pub(super) fn published(into: &Path) -> Result<Vec<PublishedRun>, PublishError> {
    let mut folders: Vec<String> = std::fs::read_dir(into)
        .map_err(io(into))?
        .flatten()
        .filter(|entry| entry.path().join(ANSWERS_FOLDER).join(ANSWER_FILE).exists())
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    folders.sort();
    folders
        .into_iter()
        .map(|folder| {
            let record = AnswerRecord::read(&into.join(&folder))?;
            Ok(PublishedRun { folder, record })
        })
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
    for PublishedRun { folder, record } in &runs {
        let link = markdown::link(&record.name, &format!("{folder}/{SUMMARY_FILE}"));
        table.row_with_link(&link, &[record.question.as_str(), record.headline()]);
    }
    let mut text = format!(
        "# Published runs\n\n`splitsum answers --publish` writes this page. Remarks come from \
         `NAME/{REMARK_FILE}`.\n\n{table}\n"
    );
    if runs.iter().any(|run| run.record.is_cpu_timed) {
        text += "**Times from a CPU driver say nothing about a GPU.** Errors do not depend on the \
                 device's speed.\n\n";
    }
    for run in &runs {
        text += &section(run, &into.join(&run.folder));
    }
    let path = into.join(PAGE);
    write_atomically(&path, |writer| writeln!(writer, "{}", text.trim_end()))?;
    Ok(path)
}

/// The answers of a run with links to its files.
fn section(PublishedRun { folder, record }: &PublishedRun, dir: &Path) -> String {
    let mut text = format!(
        "## {}\n\n{}\n\n**{}**\n\n",
        inline(&record.name),
        paragraph(&record.question),
        inline(record.plain_headline())
    );
    for answer in record.answers.iter().skip(1) {
        text += &format!("- {}\n", paragraph(&answer.sentence));
    }
    let remark = read_text(&dir.join(REMARK_FILE), TEXT_BYTES_MAX).unwrap_or_default();
    if !remark.trim().is_empty() {
        text += &format!("\n{}\n", remark.trim());
    }
    let mut links: Vec<String> = Vec::new();
    for figure in record
        .files
        .iter()
        .filter_map(|name| name.strip_suffix(".svg"))
    {
        links.push(format!(
            "[{figure}]({folder}/{ANSWERS_FOLDER}/{figure}.svg)"
        ));
    }
    let mut names = names_in(dir).into_iter();
    if let Some(sheet) = names.find(|name| name.ends_with(".svg")) {
        links.push(markdown::link(
            "contact sheet",
            &format!("{folder}/{sheet}"),
        ));
    }
    links.push(format!("[all numbers]({folder}/{SUMMARY_FILE})"));
    let failed = if record.failed > 0 {
        format!(", {} failed", record.failed)
    } else {
        String::new()
    };
    let commit = record
        .commit
        .get(..12)
        .map_or_else(String::new, |commit| format!(", commit {commit}"));
    let changed = if record.has_changes {
        " with changes"
    } else {
        ""
    };
    text += &format!(
        "\n{}\n\n{} cells{failed} on {}{}, {}{commit}{changed}.\n\n",
        links.join(" · "),
        record.cells,
        inline(&record.devices.join("; ")),
        if record.is_cpu_timed { " (CPU)" } else { "" },
        record.date_utc
    );
    text
}
