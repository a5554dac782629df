//! A static site of published runs: an index, the pages of `results/` as HTML with their files, and
//! reports. No page makes a request beyond it.
//!
//! The index is Markdown with blocks, as README.md is, so its numbers are the numbers of the
//! published runs.

use super::blocks::fill;
use super::page::render::style;
use super::page::{PAGE_FILE, PageOptions, PageRun, is_page, write as write_report};
use super::publish::{PAGE, PublishError, io, make_folder, misuse, published};
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
    /// The cell whose pictures lead the report.
    cell: Option<String>,
}

/// Writes the site of the published runs in `results` to `out`, with the reports of `runs`. Returns
/// its bytes, and omissions.
pub fn write(
    results: &Path,
    runs: &[(Finished, Vec<Answer>)],
    out: &Path,
) -> Result<(u64, Vec<String>), PublishError> {
    let is_site = is_page(&out.join(INDEX_FILE));
    if !is_site && (out.is_file() || !names_in(out).is_empty()) {
        return misuse(
            out,
            "exists and is not a site of splitsum; choose a new folder",
        );
    }
    let own = published(results)?;
    if own.is_empty() {
        return misuse(
            results,
            "has no published run; expected the folder of `splitsum answers --publish`",
        );
    }
    let place_in_results = relative(results, out);
    if !place_in_results.starts_with("..") && Path::new(&place_in_results).is_relative() {
        let results = results.display();
        return misuse(
            out,
            &format!("is in {results}, whose files the site copies; choose another folder"),
        );
    }
    let entry = |(record, folder)| Entry {
        folder,
        record,
        has_report: false,
        cell: None,
    };
    let mut entries: Vec<Entry> = own.into_iter().map(entry).collect();
    let shown: Vec<usize> = runs
        .iter()
        .map(|run| place(&entries, run))
        .collect::<Result<_, _>>()?;
    let site = Site { results, out };
    site.copy(Path::new(""))?;
    let mut notes = Vec::new();
    for (done, (run, place)) in runs.iter().zip(shown).enumerate() {
        let file = out.join(&entries[place].folder).join(PAGE_FILE);
        let budget = BYTES_MAX.saturating_sub(bytes(out)) as usize / (runs.len() - done);
        let options = PageOptions {
            out: file,
            budget,
            is_alone: true,
            ..PageOptions::in_folder(&run.0.dir)
        };
        let written = write_report(&options, &PageRun::of_runs(std::slice::from_ref(run)))?;
        notes.extend(
            written
                .notes
                .iter()
                .map(|note| format!("{}: {note}", options.out.display())),
        );
        (entries[place].has_report, entries[place].cell) = (true, written.cell);
    }
    site.index(&entries)?;
    let bytes = bytes(out);
    if bytes > BYTES_MAX {
        let [bytes, most] = [bytes, BYTES_MAX].map(|bytes| bytes as f64 / 1e6);
        return misuse(
            out,
            &format!("takes {bytes:.1} MB, more than {most} MB: name fewer runs"),
        );
    }
    Ok((bytes, notes))
}

/// The entry of a run, whose leading answer must be the published one; times differ from run to
/// run.
fn place(
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

fn bytes(folder: &Path) -> u64 {
    let paths = names_in(folder).into_iter().map(|name| folder.join(name));
    paths
        .map(|path| {
            if path.is_dir() {
                bytes(&path)
            } else {
                path.metadata().map_or(0, |file| file.len())
            }
        })
        .sum()
}

impl Site<'_> {
    /// Copies a folder of `results` and all below; Markdown becomes HTML.
    fn copy(&self, folder: &Path) -> Result<(), PublishError> {
        make_folder(&self.out.join(folder))?;
        for name in names_in(&self.results.join(folder)) {
            let own = folder.join(&name);
            let from = self.results.join(&own);
            match name.strip_suffix(".md") {
                _ if name.starts_with('.') => {}
                _ if from.is_dir() => self.copy(&own)?,
                Some(_) => {
                    self.page(&own, &read_text(&from, TEXT_BYTES_MAX).map_err(io(&from))?)?
                }
                None => drop(std::fs::copy(&from, self.out.join(&own)).map_err(io(&from))?),
            }
        }
        Ok(())
    }

    /// Writes a page of Markdown as HTML; `own` is its path in `results`.
    fn page(&self, own: &Path, markdown: &str) -> Result<(), PublishError> {
        let folder = own.parent().unwrap_or(Path::new(""));
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
        Ok(write_atomically(
            &self.out.join(own).with_extension("html"),
            |file| file.write_all(text.as_bytes()),
        )?)
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

    fn index(&self, entries: &[Entry]) -> Result<(), PublishError> {
        let docs = self.results.join("..").join("docs");
        let pictures = PICTURES
            .into_iter()
            .filter(|name| std::fs::copy(docs.join(name), self.out.join(name)).is_ok());
        let is_published = |name: &String| entries.iter().any(|entry| entry.folder == *name);
        let others = names_in(self.results)
            .into_iter()
            .filter(|name| !is_published(name));
        let page = |name: String| {
            Some((
                read_text(&self.results.join(&name).join(PAGE), TEXT_BYTES_MAX).ok()?,
                name,
            ))
        };
        let pages: BTreeMap<String, String> = others
            .filter_map(page)
            .map(|(text, name)| (name, text))
            .collect();
        let mut environment = Environment::new();
        environment.add_filter("inline", |text: String| inline(&text));
        environment.add_filter("paragraph", |text: String| paragraph(&text));
        environment.add_filter("label", |text: String| link_label(&text));
        let context = context! {
            runs => Serde(entries),
            pictures => pictures.collect::<Vec<_>>(),
            pages => Serde(pages),
        };
        let text = environment
            .render_str(INDEX, context)
            .expect("the index is a template");
        let text = fill(&text, self.results).map_err(PublishError::Misuse)?;
        self.page(Path::new("index.md"), &text)
    }
}
