//! Published runs: the small files of finished runs in a folder for git, and a page with the answers of all of them.

use super::folder::{ANSWER_FILE, AnswerRecord, AnswersError, FOLDER, SUMMARY_FILE};
use crate::experiment::sheets::sheet_files;
use crate::experiment::summary::{SHEETS_FOLDER, sheet_link};
use crate::files::{TEXT_BYTES_MAX, read_text};
use crate::pixels::{PixelsError, png, write_atomically};
use crate::slips;
use crate::table::markdown::{Align, MarkdownTable};
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Files of a run that are published beside its answers.
const FILES: [&str; 9] = [
    "experiment.toml",
    "provenance.json",
    "environments.csv",
    "errors.csv",
    "errors_by_n_dot_v.csv",
    slips::FILE_NAME,
    "timings.csv",
    "timing_ratios.csv",
    SUMMARY_FILE,
];
/// Larger files stay where they are: the folder is kept in git.
const FILE_BYTES_MAX: u64 = 1 << 20;
/// The contact sheet that is published, the first that fits: its width, pixels, and its height when it has that width.
const SHEET_WIDTH_MAX: u32 = 1200;
const SHEET_HEIGHT_MAX: u32 = 2400;
/// What a person adds to the published folder of a run: kept, and read into the page.
const REMARK_FILE: &str = "remark.md";
/// The page over all runs.
const PAGE: &str = "README.md";

/// Why a run could not be published.
#[derive(Debug, thiserror::Error)]
pub enum PublishError {
    #[error(transparent)]
    Answers(#[from] AnswersError),
    #[error("{}: {error}", path.display())]
    Io { path: PathBuf, error: std::io::Error },
    #[error(transparent)]
    Picture(#[from] PixelsError),
    #[error("{}: is the folder of the run itself; expected another one to publish into", path.display())]
    Itself { path: PathBuf },
}

fn io(path: &Path) -> impl Fn(std::io::Error) -> PublishError + '_ {
    move |error| PublishError::Io { path: path.to_owned(), error }
}

/// Copies what is small of the run in `dir`, which has its answers, to `into/NAME`. Returns what was left out, one sentence each.
pub fn publish(dir: &Path, into: &Path) -> Result<Vec<String>, PublishError> {
    let record = AnswerRecord::read(dir)?;
    let target = into.join(&record.name);
    std::fs::create_dir_all(target.join(FOLDER)).map_err(io(&target))?;
    let same = |a: &Path, b: &Path| std::fs::canonicalize(a).ok() == std::fs::canonicalize(b).ok();
    if same(dir, &target) {
        return Err(PublishError::Itself { path: target });
    }
    let mut names: Vec<PathBuf> = FILES.iter().map(PathBuf::from).collect();
    names.extend(record.files.iter().map(|name| Path::new(FOLDER).join(name)));
    names.push(Path::new(FOLDER).join(ANSWER_FILE));
    let mut notes = Vec::new();
    // What an earlier publication left and this one does not have must not stand beside it.
    for folder in [target.clone(), target.join(FOLDER)] {
        for entry in std::fs::read_dir(&folder).map_err(io(&folder))?.flatten() {
            if !entry.path().is_file() || entry.file_name() == REMARK_FILE {
                continue;
            }
            std::fs::remove_file(entry.path()).map_err(io(&folder))?;
        }
    }
    for name in names {
        let from = dir.join(&name);
        match std::fs::metadata(&from) {
            Err(_) => {}
            Ok(file) if file.len() > FILE_BYTES_MAX => {
                notes.push(format!("{}: left out, {:.1} MB", from.display(), file.len() as f64 / 1e6));
            }
            Ok(_) => {
                std::fs::copy(&from, target.join(&name)).map_err(io(&from))?;
            }
        }
    }
    let sheets = sheet_files(dir);
    let mut published = None;
    for sheet in &sheets {
        let image = png::read_rgb8(sheet)?;
        let width = image.width.min(SHEET_WIDTH_MAX);
        let height = (u64::from(image.height) * u64::from(width) / u64::from(image.width)).max(1) as u32;
        if height > SHEET_HEIGHT_MAX {
            notes.push(format!("{}: left out, {}x{} pixels", sheet.display(), image.width, image.height));
            continue;
        }
        let name = sheet.file_name().map_or_else(|| "sheet.png".into(), |name| name.to_owned());
        png::write_rgb8(&target.join(&name), &image.shrunk(width, height))?;
        published = name.into_string().ok();
        break;
    }
    let summary = target.join(SUMMARY_FILE);
    let text = read_text(&summary, TEXT_BYTES_MAX).map_err(io(&summary))?;
    let text = with_published_sheets(&text, &sheets, published.as_deref());
    write_atomically(&summary, |writer| writer.write_all(text.as_bytes()))?;
    Ok(notes)
}

/// The summary with links to those sheets only that are published beside it.
fn with_published_sheets(summary: &str, sheets: &[PathBuf], published: Option<&str>) -> String {
    let names = sheets.iter().filter_map(|sheet| sheet.file_name()?.to_str());
    names.fold(summary.to_owned(), |text, name| {
        let link = sheet_link(name);
        match published == Some(name) {
            true => text.replace(&link, &link.replace(&format!("]({SHEETS_FOLDER}/"), "](")),
            false => text.replace(&link, link.split(['[', ']']).nth(1).unwrap_or(&link)),
        }
    })
}

/// Writes `README.md` of a folder of published runs: the answers of all of them. Returns its path.
pub fn write_page(into: &Path) -> Result<PathBuf, PublishError> {
    let mut runs: Vec<Published> = Vec::new();
    for entry in std::fs::read_dir(into).map_err(io(into))?.flatten() {
        if entry.path().join(FOLDER).join(ANSWER_FILE).exists() {
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
    let mut text = "# The answers in a page\n\nWritten by `splitsum answers --publish` from the runs in this folder; only the remarks are a person's (`NAME/remark.md`). Each run has its \
                    tables, pictures and provenance; its summary says more.\n\n"
        .to_owned();
    let mut table = MarkdownTable::new(&[("run", Align::Left), ("question", Align::Left), ("answer", Align::Left)]);
    for Published { folder, run, .. } in runs {
        table.row(&[&format!("[{}]({folder}/{SUMMARY_FILE})", run.name), &run.question, &run.answer.sentence]);
    }
    text += &format!("{table}\n");
    if runs.iter().any(|published| published.run.is_cpu_timed) {
        text += "**All times are those of a CPU driver where it is named below: they say nothing about a GPU.** Errors do not depend on the \
                 device's speed.\n\n";
    }
    for Published { folder, remark, sheet, run } in runs {
        text += &format!("## {}\n\n{}\n\n**{}**\n\n", run.name, run.question, run.answer.sentence);
        text.extend(run.answer.facts.iter().map(|fact| format!("- {fact}\n")));
        if !remark.trim().is_empty() {
            text += &format!("\n{}\n", remark.trim());
        }
        let pictures: Vec<&String> = run.files.iter().filter(|name| name.ends_with(".svg")).collect();
        if !pictures.is_empty() {
            text.push('\n');
        }
        for name in pictures {
            let about = name.trim_end_matches(".svg").replace('_', " ");
            text += &format!("[{about}]({folder}/{FOLDER}/{name}) · ");
        }
        if let Some(sheet) = sheet {
            text += &format!("[contact sheet]({folder}/{sheet}) · ");
        }
        text += &format!("[all numbers]({folder}/{SUMMARY_FILE})\n\n");
        let failed = if run.failed > 0 { format!(", {} failed", run.failed) } else { String::new() };
        let commit = run.commit.get(..12).map_or_else(String::new, |commit| format!(", commit {commit}"));
        text += &format!(
            "{} cells{failed} on {}{}, {}{commit}.\n\n",
            run.cells,
            run.devices.join("; "),
            if run.is_cpu_timed { " (CPU)" } else { "" },
            run.date_utc
        );
    }
    text.trim_end().to_owned() + "\n"
}
