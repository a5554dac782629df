//! Published runs: the small files of finished runs in a folder for git, and a page with the answers of all of them.

use super::record::{ANSWER_FILE, AnswerRecord, WriteError};
use super::summary::{SHEETS_FOLDER, bold, sheet_link, sheet_title};
use super::write::SUMMARY_FILE;
use crate::files::{TEXT_BYTES_MAX, read_text, relative};
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

/// Files of a run that are published beside its answers.
const FILES: [&str; 7] =
    [EXPERIMENT_FILE, "environments.csv", "errors.csv", "steps.csv", "timings.csv", "timing_ratios.csv", SUMMARY_FILE];
/// Larger files stay where they are: the folder is kept in git.
const FILE_BYTES_MAX: u64 = 1 << 20;
/// A larger contact sheet is shrunk further, bytes.
const SHEET_BYTES_MAX: usize = 300_000;
/// Folders of a run that are published: the raw samples of its timings.
const FOLDERS: [&str; 1] = [TIMINGS_FOLDER];
/// More than this in one of them stays where it is, too, bytes.
const FOLDER_BYTES_MAX: u64 = 1 << 20;
/// What a person adds to the published folder of a run: kept, and read into the page.
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
    #[error("{}: {error}", path.display())]
    Io { path: PathBuf, error: std::io::Error },
    #[error(transparent)]
    Picture(#[from] PixelsError),
    #[error("{}: cannot be made: {error}; expected a place where this user may write", path.display())]
    Folder { path: PathBuf, error: std::io::Error },
    #[error("{}: is the folder of the run itself; expected another one to publish into", path.display())]
    Itself { path: PathBuf },
    #[error("{}: is a file; expected a folder of published runs, or the name of one to make", path.display())]
    NotAFolder { path: PathBuf },
    #[error("{}: holds files but no published run; expected a folder of published runs", path.display())]
    NotPublished { path: PathBuf },
    #[error(
        "{}: holds the published run of plan {published}, and {} is one of plan {new}; to publish it in its place give --replace",
        path.display(), dir.display()
    )]
    OtherPlan { path: PathBuf, published: String, dir: PathBuf, new: String },
}

impl PublishError {
    /// Whether the user named a wrong folder, rather than a file failing.
    pub fn is_misuse(&self) -> bool {
        !matches!(self, Self::Answers(_) | Self::Io { .. } | Self::Picture(_))
    }
}

/// Fails when publishing the run in `dir` into a folder would put it in the place of something else: of the run of another plan, unless
/// `replace`, or of files that were never published. The same plan again, run anew, is no such case.
pub fn check(dir: &Path, into: &Path, replace: bool) -> Result<(), PublishError> {
    let new = provenance(dir)?;
    let target = into.join(new["name"].as_str().unwrap_or_default());
    if let Some(file) = [into, &target].into_iter().find(|path| path.is_file()) {
        return Err(PublishError::NotAFolder { path: file.to_owned() });
    }
    let same =
        |a: &Path, b: &Path| std::fs::canonicalize(a).is_ok_and(|a| std::fs::canonicalize(b).is_ok_and(|b| a == b));
    if same(dir, &target) {
        return Err(PublishError::Itself { path: target });
    }
    let is_a_file = |entry: &std::fs::DirEntry| entry.path().is_file() && entry.file_name() != REMARK_FILE;
    let has_files = std::fs::read_dir(&target).into_iter().flatten().flatten().any(|entry| is_a_file(&entry));
    if !has_files {
        return Ok(());
    }
    if !target.join(ANSWERS_FOLDER).join(ANSWER_FILE).exists() {
        return Err(PublishError::NotPublished { path: target });
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
    Err(PublishError::OtherPlan { path: target, published, dir: dir.to_owned(), new })
}

fn io(path: &Path) -> impl Fn(std::io::Error) -> PublishError + '_ {
    move |error| PublishError::Io { path: path.to_owned(), error }
}

/// Copies what is small of the run in `dir`, which has its answers, to `into/NAME`, in the place of the published run of another plan only
/// if `replace` says so ([`check`]). Returns what was left out, one sentence each.
pub fn publish(dir: &Path, into: &Path, replace: bool) -> Result<Vec<String>, PublishError> {
    check(dir, into, replace)?;
    let record = AnswerRecord::read(dir)?;
    let target = into.join(&record.name);
    std::fs::create_dir_all(target.join(ANSWERS_FOLDER))
        .map_err(|error| PublishError::Folder { path: target.clone(), error })?;
    let answers = record.files.iter().map(String::as_str).chain([ANSWER_FILE]);
    let answers = answers.map(|name| Path::new(ANSWERS_FOLDER).join(name));
    let mut notes = Vec::new();
    let mut left_out: Vec<String> = Vec::new();
    let mut leave_out = |name: &str, bytes: u64| {
        let size = format!("{:.1} MB", bytes as f64 / 1e6);
        notes.push(format!("{}: left out, {size}", dir.join(name).display()));
        left_out.push(format!("{name} ({size})"));
    };
    // What an earlier publication left and this one does not have must not stand beside it.
    let folders = FOLDERS.map(|name| target.join(name)).into_iter().filter(|folder| folder.is_dir());
    for folder in [target.clone(), target.join(ANSWERS_FOLDER)].into_iter().chain(folders) {
        for entry in std::fs::read_dir(&folder).map_err(io(&folder))?.flatten() {
            if !entry.path().is_file() || entry.file_name() == REMARK_FILE {
                continue;
            }
            std::fs::remove_file(entry.path()).map_err(io(&folder))?;
        }
    }
    for name in FILES.iter().map(PathBuf::from).chain(answers) {
        let from = dir.join(&name);
        match std::fs::metadata(&from) {
            Err(_) => {}
            Ok(file) if file.len() > FILE_BYTES_MAX => leave_out(&name.to_string_lossy(), file.len()),
            Ok(_) => {
                std::fs::copy(&from, target.join(&name)).map_err(io(&from))?;
            }
        }
    }
    write_provenance(dir, &target)?;
    for name in FOLDERS {
        if let Some(size) = copy_folder(&dir.join(name), &target.join(name))? {
            leave_out(name, size);
        }
    }
    let summary = target.join(SUMMARY_FILE);
    let mut text = read_text(&summary, TEXT_BYTES_MAX).map_err(io(&summary))?;
    // The first page: what a reader of the others has seen, and what the summary names.
    if let Some(sheet) = sheet_files(dir).first() {
        let name = sheet.file_name().map_or_else(|| "sheet.png".into(), |name| name.to_string_lossy());
        let link = sheet_link(&name);
        if text.contains(&link) {
            let image = png::read_rgb8(sheet)?;
            let [mut width, mut height] = published_size([image.width, image.height]);
            let mut bytes = png::encode_rgb8(&image.shrunk(width, height)).map_err(io(sheet))?;
            // Noise does not compress: so large a file is made smaller by its texels.
            while bytes.len() > SHEET_BYTES_MAX && width.min(height) > 1 {
                [width, height] = [width, height].map(|side| (side * 7 / 8).max(1));
                bytes = png::encode_rgb8(&image.shrunk(width, height)).map_err(io(sheet))?;
            }
            write_atomically(&target.join(&*name), |writer| writer.write_all(&bytes))?;
            text = text.replace(&link, &markdown::link(sheet_title(&name), &name));
            text = text.replace(&markdown::link(SHEETS_FOLDER, SHEETS_FOLDER), &link_label(SHEETS_FOLDER));
        }
    }
    if !left_out.is_empty() {
        text += &format!("\nToo large to be published, made again by the run: {}.\n", left_out.join(", "));
    }
    write_atomically(&summary, |writer| writer.write_all(text.as_bytes()))?;
    Ok(notes)
}

/// Size of a contact sheet in a published folder. Pages are made to fit when they have the width; one of an older run may be shrunk further.
fn published_size([width, height]: [u32; 2]) -> [u32; 2] {
    let [width_max, height_max] = PUBLISHED_SIZE.map(f64::from);
    let (width, height) = (f64::from(width), f64::from(height));
    let factor = (width_max / width).min(height_max / height).min(1.0);
    [width, height].map(|side| (side * factor).floor().max(1.0) as u32)
}

/// The provenance, with the folders of the experiment's files as they are reached from the published one.
fn write_provenance(dir: &Path, target: &Path) -> Result<(), PublishError> {
    let mut value = provenance(dir)?;
    for key in [EXPERIMENT_FOLDER, SET_FOLDER] {
        if let Some(folder) = value[key].as_str() {
            value[key] = relative(target, &dir.join(folder)).into();
        }
    }
    let path = target.join(PROVENANCE_FILE);
    let text = format!("{value:#}\n");
    write_atomically(&path, |writer| writer.write_all(text.as_bytes()))?;
    Ok(())
}

/// Copies the files of a folder, where there is one; returns its size, bytes, where that is too much.
fn copy_folder(from: &Path, to: &Path) -> Result<Option<u64>, PublishError> {
    let entries = std::fs::read_dir(from).into_iter().flatten().flatten();
    let files: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(|path| path.is_file()).collect();
    let size = files.iter().filter_map(|path| Some(std::fs::metadata(path).ok()?.len())).sum::<u64>();
    if size > FOLDER_BYTES_MAX {
        return Ok(Some(size));
    }
    if !files.is_empty() {
        std::fs::create_dir_all(to).map_err(|error| PublishError::Folder { path: to.to_owned(), error })?;
    }
    for path in files {
        std::fs::copy(&path, to.join(path.file_name().unwrap_or_default())).map_err(io(&path))?;
    }
    Ok(None)
}

/// Writes `README.md` of a folder of published runs: the answers of all of them. Returns its path.
pub fn write_page(into: &Path) -> Result<PathBuf, PublishError> {
    let mut runs: Vec<Published> = Vec::new();
    for entry in std::fs::read_dir(into).map_err(io(into))?.flatten() {
        if entry.path().join(ANSWERS_FOLDER).join(ANSWER_FILE).exists() {
            let folder = entry.file_name().to_string_lossy().into_owned();
            // A remark is a person's choice; most runs have none.
            let remark = read_text(&entry.path().join(REMARK_FILE), TEXT_BYTES_MAX).unwrap_or_default();
            let files = std::fs::read_dir(entry.path()).map_err(io(into))?.flatten();
            let names = files.filter_map(|file| file.file_name().into_string().ok());
            let sheet = names.filter(|name| name.ends_with(".png")).min();
            runs.push(Published { folder, remark, sheet, run: AnswerRecord::read(&entry.path())? });
        }
    }
    runs.sort_by(|a, b| a.folder.cmp(&b.folder));
    let path = into.join(PAGE);
    let text = page(&runs);
    write_atomically(&path, |writer| writer.write_all(text.as_bytes()))?;
    Ok(path)
}

/// A run in a folder of published ones.
struct Published {
    /// Name of its folder.
    folder: String,
    /// What a person wrote of it.
    remark: String,
    /// File of the contact sheet.
    sheet: Option<String>,
    run: AnswerRecord,
}

/// The page over published runs.
fn page(runs: &[Published]) -> String {
    let mut text = "# Published runs\n\nThis page is written by `splitsum answers --publish`. The remarks are a person's (`NAME/remark.md`).\n\n"
        .to_owned();
    let mut table = MarkdownTable::new(&[("run", Align::Left), ("question", Align::Left), ("answer", Align::Left)]);
    for Published { folder, run, .. } in runs {
        let link = markdown::link(&run.name, &format!("{folder}/{SUMMARY_FILE}"));
        table.row_with_link(&link, &[run.question.as_str(), run.headline()]);
    }
    text += &format!("{table}\n");
    if runs.iter().any(|published| published.run.is_cpu_timed) {
        text += "**Times from a CPU driver say nothing about a GPU.** Errors do not depend on the device's speed.\n\n";
    }
    for Published { folder, remark, sheet, run } in runs {
        let (name, question) = (inline(&run.name), paragraph(&run.question));
        text += &format!("## {name}\n\n{question}\n\n{}\n\n", bold(run.headline()));
        text.extend(run.answers.iter().skip(1).map(|answer| format!("- {}\n", paragraph(&answer.sentence))));
        if !remark.trim().is_empty() {
            text += &format!("\n{}\n", remark.trim());
        }
        let pictures: Vec<&String> = run.files.iter().filter(|name| name.ends_with(".svg")).collect();
        if !pictures.is_empty() {
            text.push('\n');
        }
        for name in pictures {
            let about = name.trim_end_matches(".svg");
            text += &format!("[{about}]({folder}/{ANSWERS_FOLDER}/{name}) · ");
        }
        if let Some(sheet) = sheet {
            text += &format!("{} · ", markdown::link("contact sheet", &format!("{folder}/{sheet}")));
        }
        text += &format!("[all numbers]({folder}/{SUMMARY_FILE})\n\n");
        let failed = if run.failed > 0 { format!(", {} failed", run.failed) } else { String::new() };
        let commit = run.commit.get(..12).map_or_else(String::new, |commit| format!(", commit {commit}"));
        text += &format!(
            "{} cells{failed} on {}{}, {}{commit}.\n\n",
            run.cells,
            inline(&run.devices.join("; ")),
            if run.is_cpu_timed { " (CPU)" } else { "" },
            run.date_utc
        );
    }
    text.trim_end().to_owned() + "\n"
}

/// Begins a block of README that [`write_readme`] fills: `<!-- answer RUN QUESTION COLUMN=CELL ... -->`.
const BLOCK_START: &str = "<!-- answer ";
/// Ends such a block.
const BLOCK_END: &str = "<!-- /answer -->";

/// Fills the blocks of the README beside a folder of published runs: the sentence and the digest of one answer each. Returns its path where
/// it has blocks.
pub fn write_readme(into: &Path) -> Result<Option<PathBuf>, PublishError> {
    let path = into.parent().unwrap_or(Path::new("")).join(PAGE);
    let Ok(text) = read_text(&path, TEXT_BYTES_MAX) else { return Ok(None) };
    let filled = with_answers(&text, into)?;
    if filled != text {
        write_atomically(&path, |writer| writer.write_all(filled.as_bytes()))?;
    }
    Ok(text.contains(BLOCK_START).then_some(path))
}

/// A text with its blocks filled from the published runs in `into`; a block of a run or question that is not there stays.
pub fn with_answers(text: &str, into: &Path) -> Result<String, PublishError> {
    let mut parts = text.split(BLOCK_START);
    let mut filled = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (head, rest) = part.split_once("-->").unwrap_or((part, ""));
        let (old, after) = rest.split_once(BLOCK_END).unwrap_or((rest, ""));
        let content = block(head, into)?.unwrap_or_else(|| old.to_owned());
        filled += &format!("{BLOCK_START}{head}-->{content}{BLOCK_END}{after}");
    }
    Ok(filled)
}

/// The content of a block with this head: "RUN QUESTION", and which rows of the digest, "COLUMN=CELL", to show.
fn block(head: &str, into: &Path) -> Result<Option<String>, PublishError> {
    let mut words = head.split_whitespace();
    let (Some(run), Some(question)) = (words.next(), words.next()) else { return Ok(None) };
    let wanted: Vec<(&str, &str)> = words.filter_map(|word| word.split_once('=')).collect();
    let dir = into.join(run);
    if !dir.join(ANSWERS_FOLDER).join(ANSWER_FILE).exists() {
        return Ok(None);
    }
    let record = AnswerRecord::read(&dir)?;
    let answer = record.answers.into_iter().find(|answer| answer.question == question);
    Ok(answer.map(|answer| format!("\n{}\n\n{}\n", paragraph(&answer.sentence), rows_with(&answer.digest, &wanted))))
}

/// The rows of a Markdown table with these cells, without the columns that hold them.
fn rows_with(table: &str, wanted: &[(&str, &str)]) -> String {
    let rows: Vec<Vec<&str>> = table.lines().map(|line| line.trim_matches('|').split('|').collect()).collect();
    let names: Vec<&str> = rows.first().map_or(vec![], |head| head.iter().map(|name| name.trim()).collect());
    let cell = |name: &str| wanted.iter().find(|(column, _)| *column == name).map(|(_, cell)| *cell);
    let is_wanted =
        |row: &&Vec<&str>| names.iter().zip(*row).all(|(name, own)| cell(name).is_none_or(|cell| cell == own.trim()));
    let shown = rows.iter().take(2).chain(rows.iter().skip(2).filter(is_wanted));
    let line = |row: &Vec<&str>| {
        let cells = names.iter().zip(row).filter(|(name, _)| cell(name).is_none());
        format!("|{}|\n", cells.map(|(_, own)| *own).collect::<Vec<_>>().join("|"))
    };
    shown.map(line).collect()
}
