//! Runs in chunks, with a renderer made of formulas: how a plan is cut, what a plan file refuses, what a merge makes of attempts that
//! were killed, repeated, or made on several devices.

use super::fake::Log;
use super::runs::{Silent, contents, fakes, finished, read, rewrite};
use splitsum::experiment::chunk::split::split;
use splitsum::experiment::chunk::{
    ChunkError, ChunkOptions, ChunkOutcome, MergeOptions, Merged, PlanFile, Rates, merge, run_chunk,
};
use splitsum::experiment::timing::{self, TimingRecord};
use splitsum::experiment::timing_ratios::ratios;
use splitsum::experiment::{Plan, RunError};
use splitsum::pixels::{GrayImage, RgbImage, exr};
use splitsum::table::csv::Table;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::atomic::AtomicBool;

const EXPERIMENT: &str = r#"
name = "tiny"
question = "When does sampling win?"
size = [24, 24]
reference = { samples = 64 }
[axes]
alpha = [0.1, 0.5]
environment = ["sky.exr", "builtin:constant"]
brdf = ["ggx", "phong"]
method = ["sampled", "split-sum"]
samples = [1, 4, 16]
exposure = [1, 10]
[timing]
rounds = 6
warmup = 1
"#;
const CELLS: usize = 64;
/// Cells of one reference: four images at two exposures.
const GROUP_CELLS: usize = 8;

/// A folder with the experiment and its environment, and a plan file for it.
struct Bench {
    dir: tempfile::TempDir,
    file: PlanFile,
    plan: Plan,
}

impl Bench {
    /// A plan file with chunks of `seconds` at the default rates, less the second that each start is reckoned with.
    fn new(seconds: f64) -> Self {
        let dir = tempfile::tempdir().unwrap();
        std::fs::write(dir.path().join("tiny.toml"), EXPERIMENT).unwrap();
        write_environment(dir.path(), 1.0);
        let plan = load(dir.path());
        PlanFile::new(&plan, seconds + Rates::default().seconds_per_chunk, Rates::default())
            .write(&dir.path().join("plan.json"))
            .unwrap();
        let (file, plan) = PlanFile::load(&dir.path().join("plan.json")).unwrap();
        Self { dir, file, plan }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    fn chunk(&self, chunk: usize, log: &Rc<RefCell<Log>>) -> Result<ChunkOutcome, ChunkError> {
        let stop = AtomicBool::new(false);
        let options = ChunkOptions {
            plan_file: self.path("plan.json"),
            chunk,
            store: self.path("store"),
            stop: &stop,
            command_line: vec!["splitsum".to_owned()],
            fail_fast: false,
        };
        run_chunk(&self.file, &self.plan, &mut fakes(log), &options, &mut Silent)
    }

    /// Does a chunk on a device of that name and counts the renders.
    fn chunk_on(&self, device: &'static str, chunk: usize) -> usize {
        let log = log(device);
        assert!(self.chunk(chunk, &log).unwrap().failures.is_empty());
        log.borrow().renders.len()
    }

    fn merge(&self) -> Result<Merged, ChunkError> {
        let (store, out) = (self.path("store"), self.path("merged"));
        merge(&self.file, &self.plan, &MergeOptions { store, out, command_line: Vec::new(), trace: true })
    }

    /// The folder that a run on one machine leaves.
    fn whole(&self) -> PathBuf {
        finished(&self.plan, &self.path("whole"))
    }

    /// The folders of the attempts at a chunk, in order.
    fn attempts(&self, chunk: usize) -> Vec<PathBuf> {
        let entries = std::fs::read_dir(self.path("store/chunks").join(format!("{chunk:05}"))).unwrap();
        let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
        paths.sort_by_key(|path| std::fs::metadata(path.join("provenance.json")).unwrap().modified().unwrap());
        paths
    }

    /// Names of the files in a folder of the merged run.
    fn names(&self, folder: &Path) -> BTreeSet<String> {
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }
}

fn write_environment(dir: &Path, radiance: f32) {
    let (rgb, alpha) = (RgbImage::filled(32, 16, [radiance; 3]), GrayImage::filled(32, 16, 1.0));
    exr::write_rgba(&dir.join("sky.exr"), &rgb, &alpha, &[]).unwrap();
}

fn load(dir: &Path) -> Plan {
    Plan::load(&dir.join("tiny.toml"), &[]).unwrap_or_else(|error| panic!("{error}"))
}

fn log(device: &'static str) -> Rc<RefCell<Log>> {
    Rc::new(RefCell::new(Log { device: Some(device), ..Log::default() }))
}

#[test]
fn every_cell_and_timing_is_in_one_chunk_whatever_the_length() {
    let bench = Bench::new(1.0);
    let (plan, rates) = (&bench.plan, Rates { seconds_per_chunk: 0.0, ..Rates::default() });
    let jobs = timing::jobs(plan);
    let block_of: BTreeMap<&str, &str> = jobs.iter().map(|job| (job.id.as_str(), job.block.as_str())).collect();
    let single = split(plan, 1e9, &rates);
    assert_eq!((single.len(), single[0].cells.len()), (1, CELLS));
    let order: Vec<&String> = plan.cells.iter().map(|cell| &cell.id).collect();
    assert_eq!(single[0].cells.iter().collect::<Vec<_>>(), order, "cells stand in the order of the plan");
    let mut fewest = usize::MAX;
    for seconds in [1e-6, 0.01, 0.07, 0.3, 0.5, 1.0, 1.5, 2.0, 1e3] {
        let chunks = split(plan, seconds, &rates);
        assert_eq!(chunks, split(plan, seconds, &rates));
        assert!(chunks.len() <= fewest, "{seconds} s: {} chunks", chunks.len());
        fewest = chunks.len();
        assert!(chunks.iter().enumerate().all(|(i, chunk)| chunk.index == i));
        let mut cells: Vec<&String> = chunks.iter().flat_map(|chunk| &chunk.cells).collect();
        let mut timings: Vec<&str> = chunks.iter().flat_map(|chunk| &chunk.timings).map(String::as_str).collect();
        let blocks: Vec<&str> = timings.iter().map(|id| block_of[id]).collect();
        cells.sort();
        cells.dedup();
        timings.sort_unstable();
        timings.dedup();
        assert_eq!(
            (cells.len(), timings.len()),
            (CELLS, jobs.len()),
            "{seconds} s: something is left out or done twice"
        );
        assert_eq!(chunks.iter().map(|c| c.cells.len() + c.timings.len()).sum::<usize>(), CELLS + jobs.len());
        // A block is one run of neighbours in one chunk.
        let runs = blocks.chunk_by(|a, b| a == b).count();
        assert_eq!(runs, blocks.iter().collect::<BTreeSet<_>>().len(), "{seconds} s");
        for chunk in &chunks {
            let here: usize = chunk.blocks(&jobs).iter().map(Vec::len).sum();
            assert_eq!(here, chunk.timings.len());
            for block in chunk.blocks(&jobs) {
                let members = jobs.iter().filter(|job| job.block == block_of[block[0].as_str()]).count();
                assert_eq!(block.len(), members, "{seconds} s: a block is parted");
            }
        }
    }
}

/// A group is 8 x 0.03 s for its cells; its reference and images are nothing beside that.
#[test]
fn cells_of_one_reference_and_environment_share_a_chunk() {
    let bench = Bench::new(1.0);
    let rates = Rates { samples_per_second: 1e12, seconds_per_chunk: 0.0, ..Rates::default() };
    let group_of: BTreeMap<&str, &str> =
        bench.plan.cells.iter().map(|cell| (cell.id.as_str(), cell.reference.as_str())).collect();
    let brdf_of: BTreeMap<&str, String> = bench
        .plan
        .cells
        .iter()
        .map(|cell| {
            let text = |axis| cell.point.get(axis).to_string();
            (cell.id.as_str(), format!("{} {}", text("environment"), text("brdf")))
        })
        .collect();
    let cells_of = |seconds: f64| -> Vec<Vec<String>> {
        split(&bench.plan, seconds, &rates)
            .into_iter()
            .map(|chunk| chunk.cells)
            .filter(|cells| !cells.is_empty())
            .collect()
    };
    let group = GROUP_CELLS as f64 * rates.seconds_per_cell;
    for cells in cells_of(group * 1.01) {
        let references: BTreeSet<&str> = cells.iter().map(|id| group_of[id.as_str()]).collect();
        assert_eq!((cells.len(), references.len()), (GROUP_CELLS, 1));
    }
    // Alpha is the slowest axis of the file, yet both alphas of an environment and model meet: they share a prefiltered map.
    for cells in cells_of(2.0 * group * 1.01) {
        let tables: BTreeSet<&String> = cells.iter().map(|id| &brdf_of[id.as_str()]).collect();
        assert_eq!((cells.len(), tables.len()), (2 * GROUP_CELLS, 1));
    }
    // A group is parted only when it does not fit.
    let halves = cells_of(group * 0.51);
    assert_eq!(halves.len(), 2 * CELLS / GROUP_CELLS);
    assert!(halves.iter().all(|cells| cells.len() == GROUP_CELLS / 2));
    // With a reference that outweighs the images it is never rendered twice.
    let slow = Rates { samples_per_second: 1e2, ..rates };
    assert_eq!(
        split(&bench.plan, 1e-3, &slow).iter().filter(|chunk| !chunk.cells.is_empty()).count(),
        CELLS / GROUP_CELLS
    );
}

#[test]
fn a_plan_file_has_the_same_bytes_each_time_and_refuses_what_changed() {
    let bench = Bench::new(0.3);
    let path = bench.path("plan.json");
    let text = String::from_utf8(read(path.clone())).unwrap();
    let again = PlanFile::new(&load(bench.dir.path()), bench.file.chunk_seconds, Rates::default());
    assert_eq!(again.text(), text);
    assert_eq!(again.id(), bench.file.id());
    let refused = |part: &str| {
        let error = PlanFile::load(&path).map(|_| ()).unwrap_err();
        assert!(error.is_misuse() && error.to_string().contains(part), "no {part:?} in {error}");
        assert_eq!(error.to_string().lines().count(), 1, "{error}");
        assert!(error.to_string().starts_with(&path.display().to_string()), "{error}");
    };
    let edited = |from: &str, to: &str, part: &str| {
        assert!(text.contains(from), "{from}");
        std::fs::write(&path, text.replacen(from, to, 1)).unwrap();
        refused(part);
    };
    edited("\"format_version\": 1", "\"format_version\": 9, \"colour\": 1", "format version 9, this program reads 1");
    edited("splitsum-plan", "shopping-list", "is not a plan file");
    edited("{", "", "expected a file that `splitsum plan --chunk-seconds` wrote");
    edited(
        &format!("\"program_version\": \"{}\"", env!("CARGO_PKG_VERSION")),
        "\"program_version\": \"0.0.9\"",
        "splitsum 0.0.9",
    );
    edited("\"shader_hash\": \"", "\"shader_hash\": \"0", "other shaders");
    edited("\"flip\": 1", "\"flip\": 7", "another version of the metric flip");
    edited(&bench.plan.cells[3].id, "0123456789abcdef", "its cells or chunks are not those");
    edited("\"chunk_seconds\": 1.3", "\"chunk_seconds\": 9.3", "its cells or chunks are not those");
    std::fs::write(&path, &text).unwrap();
    write_environment(bench.dir.path(), 2.0);
    refused("the input sky.exr has changed");
    write_environment(bench.dir.path(), 1.0);
    PlanFile::load(&path).unwrap();
    std::fs::write(bench.path("tiny.toml"), format!("{EXPERIMENT}# a comment\n")).unwrap();
    refused("tiny.toml has changed since the plan was made");
    std::fs::remove_file(bench.path("tiny.toml")).unwrap();
    refused("run this in the folder where the plan was made");
}

#[test]
fn a_merge_is_the_run_of_one_machine() {
    let bench = Bench::new(0.3);
    let whole = bench.whole();
    let count = bench.file.chunks.len();
    assert!(count > 4, "{count}");
    // The last first: the order is nothing.
    for chunk in (0..count).rev() {
        bench.chunk_on("fake", chunk);
        assert_eq!(bench.chunk_on("fake", chunk), 0, "what is done is not done again");
        assert_eq!(bench.attempts(chunk).len(), 1);
    }
    let merged = bench.merge().unwrap();
    assert!(merged.holes.is_empty() && merged.notes.is_empty() && merged.outcome.failures.is_empty());
    for name in ["errors.csv", "errors_by_n_dot_v.csv", "images.csv", "experiment.toml"] {
        assert!(read(bench.path("merged").join(name)) == read(whole.join(name)), "{name} differs");
    }
    for folder in ["", "images", "references", "tables", "cells", "timings", "failed"] {
        let files = |root: &Path| bench.names(&root.join(folder));
        assert_eq!(files(&bench.path("merged")), files(&whole), "{folder}");
    }
    for name in bench.names(&whole.join("images")) {
        assert!(
            read(bench.path("merged/images").join(&name)) == read(whole.join("images").join(&name)),
            "{name} differs"
        );
    }
    let provenance: serde_json::Value = serde_json::from_slice(&read(bench.path("merged/provenance.json"))).unwrap();
    assert_eq!(provenance["sessions"].as_array().unwrap().len(), count);
    assert_eq!(provenance["sessions"][2]["chunk"], 2);
    let before = read(bench.path("merged/provenance.json"));
    bench.merge().unwrap();
    assert!(read(bench.path("merged/provenance.json")) == before, "a second merge changes nothing");
}

#[test]
fn a_lost_device_leaves_its_reason_and_the_next_attempt_goes_on() {
    let bench = Bench::new(100.0);
    let lost = log("fake");
    lost.borrow_mut().renders_left = Some(12);
    let error = bench.chunk(0, &lost).unwrap_err();
    assert!(matches!(error, ChunkError::Run(RunError::DeviceLost(_))), "{error}");
    let done = bench.names(&bench.attempts(0)[0].join("cells")).len();
    assert!((1..CELLS).contains(&done), "{done}");
    let merged = bench.merge().unwrap();
    let [hole] = merged.holes.as_slice() else { panic!("{:?}", merged.holes) };
    assert_eq!((hole.chunk, hole.cells.len()), (0, CELLS - done));
    assert!(hole.block_count > 0 && hole.last.contains("unplugged"), "{hole:?}");
    assert_eq!(Table::read(&bench.path("merged/errors.csv")).unwrap().rows.len(), done);

    let renders = bench.chunk_on("fake", 0);
    assert!(renders < 40, "{renders} renders: all of it was done again");
    assert_eq!(bench.names(&bench.attempts(0)[1].join("cells")).len(), CELLS - done);
    assert!(bench.merge().unwrap().holes.is_empty());
    assert!(read(bench.path("merged/errors.csv")) == read(bench.whole().join("errors.csv")));
}

#[test]
fn a_cell_that_fails_keeps_its_reason_until_an_attempt_succeeds() {
    let bench = Bench::new(100.0);
    let broken = log("fake");
    broken.borrow_mut().broken_method = Some("split-sum");
    let outcome = bench.chunk(0, &broken).unwrap();
    assert_eq!(outcome.failures.len(), 16);
    let merged = bench.merge().unwrap();
    assert!(merged.holes.is_empty(), "{:?}", merged.holes);
    assert_eq!(merged.outcome.failures.len(), 16);
    assert!(merged.outcome.failures.iter().all(|failure| failure.reason.contains("the shader is broken")));
    bench.chunk_on("fake", 0);
    assert!(bench.merge().unwrap().outcome.failures.is_empty());
    assert!(read(bench.path("merged/errors.csv")) == read(bench.whole().join("errors.csv")));
}

#[test]
fn a_block_of_timings_without_all_its_records_is_timed_anew_as_a_whole() {
    let bench = Bench::new(100.0);
    bench.chunk_on("fake", 0);
    let jobs = timing::jobs(&bench.plan);
    let block = bench.file.chunks[0].blocks(&jobs).into_iter().find(|block| block.len() > 1).unwrap();
    let first = bench.attempts(0)[0].join("timings");
    std::fs::remove_file(first.join(format!("{}.json", block[1]))).unwrap();
    let hole = bench.merge().unwrap().holes.remove(0);
    assert_eq!((hole.cells.len(), hole.block_count), (0, 1));
    bench.chunk_on("fake", 0);
    let second = bench.attempts(0)[1].join("timings");
    assert_eq!(bench.names(&second), block.iter().map(|id| format!("{id}.json")).collect());
    // What the second attempt measured must be recognisable.
    for id in &block {
        rewrite(&second.join(format!("{id}.json")), |record| record["driver"] = "second".into());
    }
    assert!(bench.merge().unwrap().holes.is_empty());
    for id in &block {
        let record: TimingRecord =
            serde_json::from_slice(&read(bench.path(&format!("merged/timings/{id}.json")))).unwrap();
        assert_eq!(record.driver, "second", "samples of two attempts were mixed");
    }
}

#[test]
fn records_of_one_device_must_agree() {
    let bench = Bench::new(100.0);
    let id = &bench.plan.cells[5].id;
    // Two processes that began at once know nothing of each other; the first is set aside until the second is done.
    let twice = |device| {
        bench.chunk_on("fake", 0);
        let (chunk, aside) = (bench.path("store/chunks/00000"), bench.path("aside"));
        let first = bench.attempts(0)[0].clone();
        std::fs::rename(&first, &aside).unwrap();
        bench.chunk_on(device, 0);
        std::fs::rename(&aside, chunk.join(first.file_name().unwrap())).unwrap();
    };
    twice("fake");
    assert!(bench.merge().unwrap().holes.is_empty());
    let attempts = bench.attempts(0);
    assert_eq!(attempts.len(), 2);
    let path = attempts[1].join(format!("cells/{id}.json"));
    // A time is no score.
    let figure = |name: &str, text: &str| rewrite(&path, |record| record[name] = serde_json::from_str(text).unwrap());
    figure("spent", r#"{ "tables_ms": {}, "display_ms": 1e6, "score_ms": 1e6 }"#);
    bench.merge().unwrap();
    rewrite(&path, |record| record["scores"]["mae"] = "1.25e-1".into());
    let before = read(bench.path("merged/errors.csv"));
    let error = bench.merge().unwrap_err();
    assert!(!error.is_misuse());
    let text = error.to_string();
    assert!(text.contains(&format!("{id} ")) && text.contains(&path.display().to_string()), "{text}");
    assert!(text.contains("merged/cells") && text.contains("differ in mae (") && text.contains("1.25e-1"), "{text}");
    assert!(!text.contains("rmse") && !text.contains("wall_ms"), "{text}");
    assert!(read(bench.path("merged/errors.csv")) == before);
    // On another device the same difference is none.
    figure("device", r#""other""#);
    bench.merge().unwrap();
}

/// Each fault is named with its path, and a merge that meets one writes nothing: neither a new folder nor into one that is there.
#[test]
fn what_is_damaged_or_missing_ends_the_merge_before_anything_is_written() {
    let bench = Bench::new(100.0);
    bench.chunk_on("fake", 0);
    let attempt = bench.attempts(0)[0].clone();
    let names = |folder: &str, end: &str| -> Vec<PathBuf> {
        let names = bench.names(&attempt.join(folder));
        names.iter().filter(|name| name.ends_with(end)).map(|name| attempt.join(folder).join(name)).collect()
    };
    let record = attempt.join(format!("cells/{}.json", bench.plan.cells[3].id));
    let refused = |path: &Path, what: &str, damage: &dyn Fn()| {
        let whole = read(path);
        damage();
        let before = contents(&bench.path("merged"));
        let Err(error) = bench.merge() else { panic!("{what}: {} was merged", path.display()) };
        let text = error.to_string();
        assert!(matches!(error, ChunkError::Damaged(_)) && !error.is_misuse(), "{text}");
        assert!(text.contains(&path.display().to_string()) && text.contains(what), "{what}: {text}");
        assert!(contents(&bench.path("merged")) == before, "{what}: something was written");
        std::fs::write(path, whole).unwrap();
    };
    let cut = |path: &Path| std::fs::write(path, &read(path)[..40]).unwrap();
    let changed = |path: &Path| {
        let mut bytes = read(path);
        let last = bytes.len() - 7;
        bytes[last] ^= 1;
        std::fs::write(path, bytes).unwrap();
    };
    for round in ["into nothing", "into what an earlier merge left"] {
        // What an earlier merge left holds whole copies of the images, and of where references stopped.
        let ends: &[&str] = if round == "into nothing" { &[".exr", ".error.png"] } else { &[] };
        for image in ends.iter().map(|end| names("images", end)[0].clone()) {
            let image = &image;
            refused(image, "is missing; it belongs to", &|| std::fs::remove_file(image).unwrap());
            refused(image, "is not the file that its record was made from", &|| changed(image));
            refused(image, "is not the file that its record was made from", &|| cut(image));
        }
        let (timing, reference) = (names("timings", ".json")[0].clone(), names("references", ".json")[0].clone());
        let records = if round == "into nothing" { vec![&record, &timing, &reference] } else { vec![&record, &timing] };
        for path in records {
            refused(path, "its checksum does not hold", &|| {
                // A figure that somebody corrected.
                let text = String::from_utf8(read(path.clone())).unwrap();
                let place = text.find(|c: char| c.is_ascii_digit()).unwrap();
                let digit = if &text[place..=place] == "1" { "2" } else { "1" };
                std::fs::write(path, format!("{}{digit}{}", &text[..place], &text[place + 1..])).unwrap();
            });
            refused(path, "expected a file that this program wrote", &|| cut(path));
        }
        if round == "into nothing" {
            assert!(!bench.path("merged").exists());
        }
        assert!(bench.merge().unwrap().holes.is_empty(), "{round}");
        assert!(read(bench.path("merged/errors.csv")) == read(bench.whole().join("errors.csv")), "{round}");
    }
    // The chunk makes anew what is damaged, and the merge then wants only that the damaged record be gone.
    cut(&record);
    bench.chunk_on("fake", 0);
    let again = bench.attempts(0)[1].join("cells");
    assert_eq!(bench.names(&again).len(), 1);
    std::fs::remove_file(&record).unwrap();
    assert!(bench.merge().unwrap().holes.is_empty());
}

/// An image that a merge left and that was damaged since comes back from the chunks.
#[test]
fn a_damaged_image_of_a_merged_run_is_brought_again() {
    let bench = Bench::new(100.0);
    bench.chunk_on("fake", 0);
    bench.merge().unwrap();
    let name = bench.names(&bench.path("merged/images")).into_iter().find(|name| name.ends_with(".exr")).unwrap();
    let image = bench.path("merged/images").join(name);
    let whole = read(image.clone());
    // Removed first: the file is a link to that of the attempt.
    std::fs::remove_file(&image).unwrap();
    std::fs::write(&image, b"damaged").unwrap();
    assert!(bench.merge().unwrap().holes.is_empty());
    assert!(read(image) == whole);
}

#[test]
fn the_device_with_most_cells_is_taken_and_a_mix_is_told() {
    let bench = Bench::new(0.3);
    let last = bench.file.chunks.len() - 1;
    let cells = |chunk: usize| bench.file.chunks[chunk].cells.len();
    assert!(last >= 4 && cells(0) > 0 && cells(last) == 0, "the last chunk holds timings only");
    for chunk in 0..=last {
        bench.chunk_on(if chunk == 0 { "rare" } else { "usual" }, chunk);
    }
    let merged = bench.merge().unwrap();
    let usual = CELLS - cells(0);
    let note = format!("the cells come from 2 devices: {} from rare (formula), {usual} from usual (formula)", cells(0));
    assert_eq!(merged.notes, [note]);
    // The usual device does the rare one's cells, too: now it has all of them.
    std::fs::rename(bench.path("store/chunks/00000"), bench.path("aside")).unwrap();
    bench.chunk_on("usual", 0);
    let attempt = std::fs::read_dir(bench.path("aside")).unwrap().next().unwrap().unwrap();
    std::fs::rename(attempt.path(), bench.path("store/chunks/00000").join(attempt.file_name())).unwrap();
    assert!(bench.merge().unwrap().notes.is_empty());
    let record = read(bench.path(&format!("merged/cells/{}.json", bench.file.chunks[0].cells[0])));
    assert!(String::from_utf8(record).unwrap().contains("\"device\": \"usual\""));
}

#[test]
fn times_of_two_devices_are_never_compared() {
    let bench = Bench::new(100.0);
    let whole = bench.whole();
    let records: Vec<TimingRecord> = bench
        .names(&whole.join("timings"))
        .iter()
        .map(|name| serde_json::from_slice(&read(whole.join("timings").join(name))).unwrap())
        .collect();
    let of_one = ratios(&records);
    assert!(!of_one.is_empty() && of_one.iter().all(|ratio| ratio.tables_ms.is_finite()));
    let moved = |moves: fn(&TimingRecord) -> bool| -> Vec<TimingRecord> {
        let device = |r: &TimingRecord| if moves(r) { "other".to_owned() } else { r.device.clone() };
        records.iter().map(|r| TimingRecord { device: device(r), ..r.clone() }).collect()
    };
    let frames = moved(|record| record.axes["method"] == "sampled");
    assert!(ratios(&frames).is_empty());
    let tables = moved(|record| record.phase == timing::PRECOMPUTE);
    assert!(ratios(&tables).len() == of_one.len() && ratios(&tables).iter().all(|ratio| ratio.tables_ms.is_nan()));
}

#[test]
fn a_store_belongs_to_one_plan_file() {
    let bench = Bench::new(0.3);
    bench.chunk_on("fake", 0);
    let other = PlanFile::new(&bench.plan, 7.0, Rates::default());
    let options = |store: &str| MergeOptions {
        store: bench.path(store),
        out: bench.path("merged"),
        command_line: Vec::new(),
        trace: false,
    };
    let error = merge(&other, &bench.plan, &options("store")).unwrap_err();
    assert!(matches!(error, ChunkError::OtherPlan { .. }) && error.is_misuse(), "{error}");
    let error = merge(&bench.file, &bench.plan, &options("nowhere")).unwrap_err();
    assert!(matches!(error, ChunkError::NoStore { .. }) && !bench.path("merged").exists(), "{error}");
    let error = bench.chunk(99, &log("fake")).unwrap_err();
    let last = bench.file.chunks.len() - 1;
    assert!(error.to_string().contains(&format!("has no chunk 99; expected 0 to {last}")), "{error}");
}
