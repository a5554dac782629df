//! The report without a browser: embedded data, escaping, and the files it may replace.

use super::paper::{self, Made};
use crate::run::runs::{finished, plan};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use flate2::read::DeflateDecoder;
use half::f16;
use serde_json::{Value, json};
use splitsum::base::pixels::{GrayImage, HALF_MAX, RgbImage, packed};
use splitsum::report::page::images::{BUDGET_BYTES, Choice, collect};
use splitsum::report::page::render::in_script;
use splitsum::report::page::{PageOptions, PageRun, write};
use splitsum::report::write::Written;
use splitsum::study::finished::Finished;
use splitsum::study::questions::{Answer, answers};
use std::io::Read;
use std::path::{Path, PathBuf};

#[test]
fn json_in_a_script_element_cannot_end_it() {
    let value = serde_json::json!({ "</script><!--": ["<script>", "]]>", "\u{2028}", "\"=1+1"] });
    let text = in_script(&value);
    assert!(!text.contains('<'), "{text}");
    assert_eq!(
        serde_json::from_str::<serde_json::Value>(&text).unwrap(),
        value
    );
}

/// Decodes as the page does: base64, inflate, sum of differences.
pub fn decoded(text: &str, plane: usize) -> Vec<u8> {
    let mut bytes = Vec::new();
    DeflateDecoder::new(BASE64_STANDARD.decode(text).unwrap().as_slice())
        .read_to_end(&mut bytes)
        .unwrap();
    for plane in bytes.chunks_mut(plane) {
        for i in 1..plane.len() {
            plane[i] = plane[i].wrapping_add(plane[i - 1]);
        }
    }
    bytes
}

#[test]
fn an_encoded_image_decodes_to_its_nearest_halves() {
    let image = RgbImage::from_fn(5, 3, |x, y| {
        [0.1 * x as f32, 1e-7 * y as f32, 30_000.0 * (x * y) as f32]
    });
    let encoded = packed::texels(&image);
    let bytes = decoded(&encoded.base64, 15);
    for (i, texel) in image.data.iter().enumerate() {
        for (channel, value) in texel.iter().enumerate() {
            let at = channel * 30 + i;
            let half = f16::from_bits(u16::from_be_bytes([bytes[at], bytes[at + 15]]));
            assert_eq!(
                half,
                f16::from_f32(value.min(HALF_MAX)),
                "texel {i}, channel {channel}"
            );
        }
    }
    assert_eq!(
        encoded.clamped_count,
        image
            .data
            .iter()
            .filter(|texel| texel[2] > HALF_MAX)
            .count()
    );
    assert!(encoded.clamped_count > 0);
    let mask = GrayImage::from_fn(4, 4, |x, y| if x > y { 1.0 } else { 0.0 });
    assert_eq!(
        decoded(&packed::mask(&mask), 16),
        mask.data.iter().map(|m| *m as u8).collect::<Vec<u8>>()
    );
}

const EXPERIMENT: &str = r#"
name = "tiny"
question = "When does sampling win?"
size = [200, 200]
reference = { samples = 64, noise_share = 0 }
[axes]
environment = ["builtin:constant"]
alpha = [0.1, 0.5]
method = ["sampled", "split-sum"]
samples = [1, 4, 16]
exposure = [1, 10]
[timing]
warmup = 1
rounds = 3
"#;

pub fn finished_run(dir: &Path) -> PathBuf {
    finished(&plan(EXPERIMENT), &dir.join("run"))
}

pub fn read(dir: &Path) -> (Finished, Vec<Answer>) {
    let run = Finished::read(dir).unwrap_or_else(|error| panic!("{error}"));
    let answers = answers(&run, None);
    (run, answers)
}

pub fn model_of(page: &str) -> Value {
    let start = page.find("id=\"model\">").unwrap() + "id=\"model\">".len();
    let end = start + page[start..].find("</script>").unwrap();
    serde_json::from_str(&page[start..end]).unwrap()
}

#[test]
fn a_page_is_the_same_each_time_and_holds_every_cell_and_answer_once() {
    let dir = tempfile::tempdir().unwrap();
    let run = finished_run(dir.path());
    let runs = [read(&run)];
    let page_runs = PageRun::of_runs(&runs);
    let written = write(&PageOptions::in_folder(&run), &page_runs).unwrap();
    let before = std::fs::read(&written.path).unwrap();
    write(&PageOptions::in_folder(&run), &page_runs).unwrap();
    assert!(std::fs::read(&written.path).unwrap() == before);
    let page = String::from_utf8(before).unwrap();
    assert!(
        !page.contains("src=\"http")
            && !page.contains("href=\"http")
            && page.contains("default-src 'none'")
    );
    let model = model_of(&page);
    let (finished, answers) = &runs[0];
    assert_eq!(
        model["rows"].as_array().unwrap().len(),
        finished.cells.len()
    );
    let columns: Vec<&str> = model["columns"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(Value::as_str)
        .collect();
    let place = |name: &str| columns.iter().position(|column| *column == name).unwrap();
    let axis = |name: &str| {
        model["axes"]
            .as_array()
            .unwrap()
            .iter()
            .find(|axis| axis["name"] == name)
            .unwrap()
            .clone()
    };
    let roles = ["alpha", "samples", "method", "exposure", "brdf"]
        .map(|name| axis(name)["role"].as_str().unwrap().to_owned());
    assert_eq!(roles, ["scene", "variant", "variant", "display", "fixed"]);
    for (row, cell) in model["rows"]
        .as_array()
        .unwrap()
        .iter()
        .zip(&finished.cells)
    {
        assert_eq!(row[place("cell")], json!(*cell.id));
        let alpha = row[place("alpha")].as_u64().unwrap() as usize;
        assert_eq!(
            axis("alpha")["values"][alpha],
            json!(cell.point.get("alpha").to_string())
        );
        assert_eq!(
            row[place("rmse")].as_f64(),
            cell.scores.as_ref().unwrap().get("rmse")
        );
    }
    // The page holds the answers unchanged: sentence, table, both widths of the figure.
    assert!(!answers.is_empty());
    for (answer, shown) in answers.iter().zip(model["answers"].as_array().unwrap()) {
        assert_eq!(shown["name"], answer.question.name);
        assert_eq!(
            shown["rows"].as_array().unwrap().len(),
            answer.finding.table.rows.len()
        );
        assert!(page.contains(&format!("id=\"{}\"", answer.question.name)));
        for width in splitsum::draw::figure::svg::WIDTHS {
            let figure = answer
                .finding
                .figure
                .as_ref()
                .map(|figure| splitsum::draw::figure::svg::svg(figure, width));
            assert!(
                figure.is_none_or(|figure| page.contains(figure.trim_end())),
                "{}",
                answer.question.name
            );
        }
    }
}

/// An image and a row of the digest a width.
const MANY: usize = 5100;

#[test]
fn of_thousands_of_rows_readers_see_the_first() {
    let dir = tempfile::tempdir().unwrap();
    let widths: Vec<f64> = (1..=MANY)
        .map(|k| (k + MANY) as f64 / (2 * MANY) as f64)
        .collect();
    let axes = format!("alpha = {widths:?}\nmethod = [\"split-sum\"]\n");
    let run = Finished {
        dir: dir.path().to_owned(),
        ..paper::finished(&axes, |point| {
            Some(Made::error(point.get("alpha").size().unwrap()))
        })
    };
    let all = answers(&run, None);
    assert_eq!(all[0].finding.table.rows.len(), MANY);
    let summary = Written::new(&run, &all).unwrap().summary;
    // Another row is over all widths.
    let row_count = MANY + 1;
    let cut = format!("The first 100 of {row_count} rows: [all of them](answers/error_digest.csv)");
    assert!(summary.contains(&cut), "{summary}");
    let runs = [(run, all)];
    let written = write(
        &PageOptions::in_folder(dir.path()),
        &PageRun::of_runs(&runs),
    )
    .unwrap();
    let page = std::fs::read_to_string(written.path).unwrap();
    // The template writes a slash as its code.
    let page = page.replace("&#x2f;", "/");
    let cut = format!(
        "The first 100 of {row_count} rows; all of them in <a href=\"answers/error_digest.csv\">"
    );
    assert!(page.contains(&cut));
    let model = model_of(&page);
    assert_eq!(model["rows"].as_array().unwrap().len(), MANY);
    let table = &model["answers"][0];
    assert_eq!(table["row_count"], json!(MANY));
    assert_eq!(table["rows"].as_array().unwrap().len(), 200);
    // What the page lacks it cannot save.
    assert!(!page.contains("data-save=\"csv\""));
    assert!(page.contains("<a href=\"answers/error.csv\" download>CSV</a>"));
}

#[test]
fn images_over_the_budget_are_linked() {
    let dir = tempfile::tempdir().unwrap();
    let run = finished_run(dir.path());
    let runs = [read(&run)];
    let runs = PageRun::of_runs(&runs);
    let whole = collect(&runs, Choice::Automatic, BUDGET_BYTES);
    assert_eq!(whole.images.len(), 2 * (1 + 4));
    assert!(whole.notes.is_empty() && whole.images.iter().all(|image| image.size == [200; 2]));
    let bytes = |payloads: &[String]| payloads.iter().map(String::len).sum::<usize>();
    let budget = bytes(&whole.payloads) / 2;
    let cut = collect(&runs, Choice::Automatic, budget);
    // Whole images in the order of the cells, each reference before its images.
    let embedded = cut
        .images
        .iter()
        .take_while(|image| image.payload.is_some())
        .count();
    assert!(
        (4..7).contains(&embedded) && bytes(&cut.payloads) <= budget,
        "{embedded}"
    );
    assert!(
        cut.images[embedded..]
            .iter()
            .all(|image| image.payload.is_none() && image.mask.is_none())
    );
    assert_eq!(
        cut.images[0].payload.map(|payload| &cut.payloads[payload]),
        whole.payloads.first()
    );
    let note = format!("{} of 10 images exceed", 10 - embedded);
    assert!(
        cut.notes.len() == 1 && cut.notes[0].contains(&note),
        "{:?}",
        cut.notes
    );
    let none = collect(&runs, Choice::None, BUDGET_BYTES);
    assert!(none.payloads.is_empty() && none.notes.len() == 1);
}
