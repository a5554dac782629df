//! The pictures of what images are made of: made once in a run, and embedded within a tenth of the
//! page.

use crate::run::runs::{finished, plan};
use crate::study::page::{decoded, model_of, read};
use half::f16;
use serde_json::{Value, json};
use splitsum::base::names::Listed;
use splitsum::instrument::pipeline::{Encoding, Intermediate};
use splitsum::report::intermediates::{INTERMEDIATES_FILE, IntermediateRecord};
use splitsum::report::page::images::{BUDGET_BYTES, Choice, collect};
use splitsum::report::page::intermediates::PageIntermediates;
use splitsum::report::page::{PageOptions, PageRun, write};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Two widths, two maps, two methods of which one reads tables; the rest changes no picture.
const EXPERIMENT: &str = r#"
name = "tiny"
size = [64, 64]
reference = { samples = 64, noise_share = 0 }
[axes]
environment = ["builtin:constant", "builtin:constant:radiance=2"]
environment_orientation = [0, 1]
alpha = [0.1, 0.5]
method = ["sampled", "split-sum"]
samples = [1, 4, 16]
diffuse = ["none", "sh9"]
exposure = [1, 10]
"#;
const LEVEL_COUNT: usize = 5;

fn finished_run(dir: &Path) -> PathBuf {
    finished(&plan(EXPERIMENT), &dir.join("run"))
}

fn record(run: &Path) -> IntermediateRecord {
    serde_json::from_str(&std::fs::read_to_string(run.join(INTERMEDIATES_FILE)).unwrap()).unwrap()
}

#[test]
fn a_run_makes_each_picture_once_and_lists_what_each_cell_is_made_of() {
    let dir = tempfile::tempdir().unwrap();
    let run = finished_run(dir.path());
    let record = record(&run);
    let count = |name: &str| record.pictures.iter().filter(|p| p.name == name).count();
    // Widths share positions, environments share all but maps: equal pictures are kept once.
    for shared in [
        "position",
        "normal",
        "albedo",
        "f0",
        "metallic",
        "occlusion",
        "dfg",
    ] {
        assert_eq!(count(shared), 1, "{shared}");
    }
    assert_eq!(count("alpha"), 2);
    assert_eq!(count("prefiltered-0"), 2);
    assert_eq!(record.left_out, 0);
    let plan = plan(EXPERIMENT);
    for cell in &plan.cells {
        let set = &record.sets[record.cells[&cell.id.to_string()]];
        let names: Vec<&str> = set
            .iter()
            .map(|index| record.pictures[*index].name.as_str())
            .collect();
        let settings = cell.point.settings();
        let [reads_tables, has_diffuse] = [
            settings.shading.method.uses_prefiltered(),
            settings.shading.diffuse.name != "none",
        ];
        // In the order of the list, which `render --show` and the window have, too.
        let expected = Intermediate::names()
            .into_iter()
            .flat_map(|name| match name {
                "irradiance" if !has_diffuse => vec![],
                "dfg" if !reads_tables && !has_diffuse => vec![],
                "prefiltered" if !reads_tables => vec![],
                "prefiltered" => (0..LEVEL_COUNT)
                    .map(|level| format!("{name}-{level}"))
                    .collect(),
                _ => vec![name.to_owned()],
            });
        let expected: Vec<String> = expected.collect();
        let without_dfg = |names: &[&str]| -> Vec<String> {
            let others = names.iter().filter(|name| **name != "dfg");
            others.map(|name| (*name).to_owned()).collect()
        };
        let expected: Vec<&str> = expected.iter().map(String::as_str).collect();
        assert_eq!(without_dfg(&names), without_dfg(&expected), "{}", cell.id);
        assert!(!reads_tables || names.contains(&"dfg"));
    }
    // The fake renderer's ramp, masked below the middle.
    let normal = record.pictures.iter().find(|p| p.name == "normal").unwrap();
    assert!(matches!(normal.encoding, Encoding::Linear(_)));
    let bytes = decoded(&normal.texels, 64 * 64);
    let red = f16::from_bits(u16::from_be_bytes([bytes[10], bytes[64 * 64 + 10]]));
    assert_eq!(red, f16::from_f32(10.5 / 64.0));
    let mask = decoded(&normal.mask, 64 * 64);
    assert_eq!((mask[0], mask[64 * 32]), (1, 0));
}

/// The pictures add at most a tenth to a page of usual size, and a page without room for all says
/// so.
#[test]
fn the_page_grows_by_less_than_a_tenth() {
    let dir = tempfile::tempdir().unwrap();
    let run = finished_run(dir.path());
    let runs = [read(&run)];
    let page_runs = PageRun::of_runs(&runs);
    let options = PageOptions::in_folder(&run);
    let bytes_with = write(&options, &page_runs).unwrap().bytes;
    let page = std::fs::read_to_string(&options.out).unwrap();
    let model = model_of(&page);
    let pictures = model["intermediates"]["pictures"].as_array().unwrap();
    assert_eq!(pictures.len(), record(&run).pictures.len());
    assert_eq!(model["intermediates"]["notes"], json!([]));
    // Each cell has its set.
    let place = |name: &str| {
        let columns = model["columns"].as_array().unwrap();
        columns.iter().position(|column| column == name).unwrap()
    };
    let cells = record(&run).cells;
    for row in model["rows"].as_array().unwrap() {
        let set = cells[row[place("cell")].as_str().unwrap()];
        assert_eq!(row[place("intermediates")], json!(set));
    }
    std::fs::remove_file(run.join(INTERMEDIATES_FILE)).unwrap();
    let bytes_without = write(&options, &page_runs).unwrap().bytes;
    let growth = bytes_with as f64 / bytes_without as f64;
    assert!(1.0 < growth && growth < 1.1, "{growth}");
    let model = model_of(&std::fs::read_to_string(&options.out).unwrap());
    let notes = model["intermediates"]["notes"].as_array().unwrap();
    assert!(
        notes.len() == 1
            && notes[0]
                .as_str()
                .unwrap()
                .contains("splitsum render --show"),
        "{notes:?}"
    );
    let sets: BTreeSet<String> = model["rows"]
        .as_array()
        .unwrap()
        .iter()
        .map(|row| row[place("intermediates")].to_string())
        .collect();
    assert_eq!(sets, BTreeSet::from([Value::Null.to_string()]));
}

#[test]
fn pictures_beyond_a_tenth_of_the_page_are_left_out_with_a_note() {
    let dir = tempfile::tempdir().unwrap();
    let run = finished_run(dir.path());
    let runs = [read(&run)];
    let runs = PageRun::of_runs(&runs);
    let embedded = |page_bytes: usize| {
        let mut images = collect(&runs, Choice::Automatic, BUDGET_BYTES);
        let before: usize = images.payloads.iter().map(String::len).sum();
        let page = PageIntermediates::collect(&runs, &mut images, page_bytes);
        let after: usize = images.payloads.iter().map(String::len).sum();
        (page, after - before)
    };
    let (whole, bytes) = embedded(usize::MAX);
    assert!(whole.notes.is_empty());
    let page_bytes = 5 * bytes;
    let (cut, bytes) = embedded(page_bytes);
    assert!(10 * bytes <= page_bytes, "{bytes} of {page_bytes}");
    let omitted = whole.pictures.len() - cut.pictures.len();
    assert!(omitted > 0 && !cut.pictures.is_empty());
    assert!(
        cut.notes.len() == 1 && cut.notes[0].starts_with(&format!("{omitted} more")),
        "{:?}",
        cut.notes
    );
    let named = cut.sets.iter().flatten();
    assert!(named.max().unwrap() < &cut.pictures.len());
}
