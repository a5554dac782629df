//! A static site of published runs: an index, the pages of `results/` as HTML with their files, and
//! reports. No page makes a request beyond it.
//!
//! The index is Markdown with blocks, as README.md is, so its numbers are the numbers of the
//! published runs.

use super::blocks::fill;
use super::page::render::style;
use super::page::{PAGE_FILE, PageOptions, PageRun, is_page, write as write_report};
use super::publish::{PAGE, PublishError, PublishedRun, io, make_folder, misuse, published};
use super::record::AnswerRecord;
use super::write::Written;
use crate::base::files::{TEXT_BYTES_MAX, names_in, read_text, relative};
use crate::base::pixels::write_atomically;
use crate::draw::markdown::{inline, link_label, paragraph};
use crate::study::finished::Finished;
use crate::study::questions::Answer;
use minijinja::value::Serde;
use minijinja::{Environment, context};
use percent_encoding::percent_decode_str;
use pulldown_cmark::{Event, Options, Parser, Tag, TagEnd, html::push_html};
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::Path;

const SHELL: &str = include_str!("../../assets/report/gallery.html");
const INDEX: &str = include_str!("../../assets/report/gallery.md");
pub const INDEX_FILE: &str = "index.html";
pub const BYTES_MAX: u64 = 30_000_000;
/// Pictures of the index, in the folder `docs` beside the published runs.
const PICTURES: [&str; 2] = ["effect.png", "front.png"];

struct Site<'a> {
    results: &'a Path,
    out: &'a Path,
}

#[derive(Serialize)]
struct Entry {
    folder: String,
    #[serde(flatten)]
    record: AnswerRecord,
    has_report: bool,
    /// The cell of the pictures on the first screen of the report.
    cell: Option<String>,
}

impl Entry {
    /// An entry without a report.
    fn new(run: PublishedRun) -> Self {
        Self {
            folder: run.folder,
            record: run.record,
            has_report: false,
            cell: None,
        }
    }
}

/// Writes the site of the published runs in `results` to `out`, with the reports of `runs`. Returns
/// its bytes, and omissions.
pub fn write(
    results: &Path,
    runs: &[(Finished, Vec<Answer>)],
    out: &Path,
) -> Result<(u64, Vec<String>), PublishError> {
    check_out(out)?;
    let mut entries: Vec<Entry> = published(results)?.into_iter().map(Entry::new).collect();
    if entries.is_empty() {
        return misuse(
            results,
            "has no published run; expected the folder of `splitsum answers --publish`",
        );
    }
    if is_inside(results, out) {
        let results = results.display();
        return misuse(
            out,
            &format!("is in {results}, whose files the site copies; choose another folder"),
        );
    }
    // All before the first file is written.
    let entry_indices: Vec<usize> = runs
        .iter()
        .map(|run| entry_index(&entries, run))
        .collect::<Result<_, _>>()?;
    let site = Site { results, out };
    site.copy(Path::new(""))?;
    let mut notes = Vec::new();
    for (done_count, (run, index)) in runs.iter().zip(entry_indices).enumerate() {
        let entry = &mut entries[index];
        let bytes_left = BYTES_MAX.saturating_sub(bytes(out)) as usize;
        let options = PageOptions {
            out: out.join(&entry.folder).join(PAGE_FILE),
            budget: bytes_left / (runs.len() - done_count),
            is_alone: true,
            ..PageOptions::in_folder(&run.0.dir)
        };
        let written = write_report(&options, &PageRun::of_runs(std::slice::from_ref(run)))?;
        for note in &written.notes {
            notes.push(format!("{}: {note}", options.out.display()));
        }
        entry.has_report = true;
        entry.cell = written.cell;
    }
    site.index(&entries)?;
    let bytes = bytes(out);
    if bytes > BYTES_MAX {
        let megabytes = bytes as f64 / 1e6;
        let most = BYTES_MAX as f64 / 1e6;
        return misuse(
            out,
            &format!("takes {megabytes:.1} MB, more than {most} MB: name fewer runs"),
        );
    }
    Ok((bytes, notes))
}

/// Refuses a file or folder that is not a site.
fn check_out(out: &Path) -> Result<(), PublishError> {
    let is_site = is_page(&out.join(INDEX_FILE));
    if !is_site && (out.is_file() || !names_in(out).is_empty()) {
        return misuse(
            out,
            "exists and is not a site of splitsum; choose a new folder",
        );
    }
    Ok(())
}

/// Whether `path` is `folder` or below it.
fn is_inside(folder: &Path, path: &Path) -> bool {
    let from_folder = relative(folder, path);
    !from_folder.starts_with("..") && Path::new(&from_folder).is_relative()
}

/// The index of the entry of a run, whose main answer must be the published one; times differ from
/// run to run.
fn entry_index(
    entries: &[Entry],
    (run, answers): &(Finished, Vec<Answer>),
) -> Result<usize, PublishError> {
    let record = Written::new(run, answers)?.record;
    let is_same = |entry: &Entry| {
        entry.record.name == record.name && entry.record.headline() == record.headline()
    };
    let fault = "is not published with this leading answer; `splitsum answers DIR --publish \
                 FOLDER` publishes it";
    entries
        .iter()
        .position(is_same)
        .map_or_else(|| misuse(&run.dir, fault), Ok)
}

/// Size of all files in a folder.
fn bytes(folder: &Path) -> u64 {
    let mut sum = 0;
    for name in names_in(folder) {
        let path = folder.join(name);
        sum += if path.is_dir() {
            bytes(&path)
        } else {
            path.metadata().map_or(0, |file| file.len())
        };
    }
    sum
}

impl Site<'_> {
    /// Copies a folder of `results` and all below; Markdown becomes HTML.
    fn copy(&self, folder: &Path) -> Result<(), PublishError> {
        make_folder(&self.out.join(folder))?;
        for name in names_in(&self.results.join(folder)) {
            if name.starts_with('.') {
                continue;
            }
            let path = folder.join(&name);
            let from = self.results.join(&path);
            if from.is_dir() {
                self.copy(&path)?;
            } else if name.ends_with(".md") {
                let markdown = read_text(&from, TEXT_BYTES_MAX).map_err(io(&from))?;
                self.page(&path, &markdown)?;
            } else {
                std::fs::copy(&from, self.out.join(&path)).map_err(io(&from))?;
            }
        }
        Ok(())
    }

    /// Writes a page of Markdown as HTML; `path` is relative to `results`.
    fn page(&self, path: &Path, markdown: &str) -> Result<(), PublishError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut is_dropped = false;
        let events = Parser::new_ext(markdown, Options::ENABLE_TABLES).filter_map(|mut event| {
            if let Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) =
                &mut event
            {
                let link = self.link(folder, dest_url);
                is_dropped = link.is_none();
                *dest_url = link.unwrap_or_default().into();
            }
            let is_link = matches!(
                event,
                Event::Start(Tag::Link { .. } | Tag::Image { .. })
                    | Event::End(TagEnd::Link | TagEnd::Image)
            );
            (!is_dropped || !is_link).then_some(event)
        });
        let mut body = String::new();
        push_html(&mut body, events);
        let root = "../".repeat(folder.components().count());
        let context = context! { markdown, style => style(), root, body };
        let text = Environment::new()
            .render_named_str(INDEX_FILE, SHELL, context)
            .expect("the shell is a template");
        let out = self.out.join(path).with_extension("html");
        Ok(write_atomically(&out, |file| {
            file.write_all(text.as_bytes())
        })?)
    }

    /// The link of a page in `folder`, to HTML instead of Markdown; `None` if it leads out of the
    /// site, or to a file that was too large to be published.
    fn link(&self, folder: &Path, url: &str) -> Option<String> {
        let (path, anchor) = url.split_at(url.find('#').unwrap_or(url.len()));
        let file = folder.join(&*percent_decode_str(path).decode_utf8_lossy());
        let is_there = [self.results, self.out]
            .iter()
            .any(|root| root.join(&file).is_file());
        let is_inside =
            path.split('/').filter(|part| *part == "..").count() <= folder.components().count();
        let page = path
            .strip_suffix(".md")
            .map_or_else(|| path.to_owned(), |page| format!("{page}.html"));
        (is_there && is_inside).then(|| page + anchor)
    }

    /// Writes the index, with the pages of folders without a run.
    fn index(&self, entries: &[Entry]) -> Result<(), PublishError> {
        let docs = self.results.join("..").join("docs");
        let pictures: Vec<&str> = PICTURES
            .into_iter()
            .filter(|name| std::fs::copy(docs.join(name), self.out.join(name)).is_ok())
            .collect();
        let mut pages: BTreeMap<String, String> = BTreeMap::new();
        for name in names_in(self.results) {
            let is_published = entries.iter().any(|entry| entry.folder == name);
            let page = self.results.join(&name).join(PAGE);
            if let Ok(text) = read_text(&page, TEXT_BYTES_MAX)
                && !is_published
            {
                pages.insert(name, text);
            }
        }
        let mut environment = Environment::new();
        environment.add_filter("inline", |text: String| inline(&text));
        environment.add_filter("paragraph", |text: String| paragraph(&text));
        environment.add_filter("label", |text: String| link_label(&text));
        let context = context! {
            runs => Serde(entries),
            pictures,
            pages => Serde(pages),
        };
        let text = environment
            .render_str(INDEX, context)
            .expect("the index is a template");
        let text = fill(&text, self.results).map_err(PublishError::Misuse)?;
        self.page(Path::new("index.md"), &text)
    }
}
