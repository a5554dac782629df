//! Runs by several processes in one folder, with a synthetic renderer.

use super::fake::Log;
use super::runs::{Silent, assert_like_whole, contents, fakes, options, plan, read};
use splitsum::experiment::Id;
use splitsum::experiment::Plan;
use splitsum::experiment::plan::ReferenceGroup;
use splitsum::run::estimate::Steps;
use splitsum::run::shard::Shard;
use splitsum::run::split::{Share, split};
use splitsum::run::store::Store;
use splitsum::run::{MakeRenderer, Merged, Outcome, RunError, RunOptions, merge, run, timing};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::atomic::AtomicBool;

const EXPERIMENT: &str = r#"
name = "tiny"
question = "When does sampling win?"
size = [24, 24]
reference = { samples = 64, noise_share = 0 }
[axes]
alpha = [0.1, 0.5]
environment = ["builtin:sky", "builtin:constant"]
brdf = ["ggx", "phong"]
method = ["sampled", "split-sum"]
samples = [1, 4, 16]
exposure = [1, 10]
[timing]
rounds = 6
warmup = 1
"#;
const REFERENCES: usize = 8;

/// A folder that shards of a plan share.
struct Bench {
    root: tempfile::TempDir,
    plan: Plan,
}

impl Bench {
    fn new(text: &str) -> Self {
        Self {
            root: tempfile::tempdir().unwrap(),
            plan: plan(text),
        }
    }

    fn dir(&self) -> PathBuf {
        self.root.path().join("shared")
    }

    fn shard(&self, shard: &str, log: &Rc<RefCell<Log>>) -> Result<Outcome, RunError> {
        let stop = AtomicBool::new(false);
        let options = RunOptions {
            shard: Some(shard.parse().unwrap()),
            ..options(&self.dir(), &stop)
        };
        run(
            &self.plan,
            &mut fakes(log) as &mut MakeRenderer,
            &options,
            &mut Silent,
        )
    }

    fn done(&self, shard: &str) -> usize {
        let log = log("fake");
        let outcome = self
            .shard(shard, &log)
            .unwrap_or_else(|error| panic!("{error}"));
        assert!(outcome.failures.is_empty() && !outcome.is_stopped);
        log.borrow().renders.len()
    }

    /// Runs shards one after the other and counts the renders.
    fn all_done(&self, shards: &[&str]) -> usize {
        shards.iter().map(|shard| self.done(shard)).sum()
    }

    fn merge(&self) -> Result<Merged, RunError> {
        merge(&self.plan, &options(&self.dir(), &AtomicBool::new(false)))
    }

    fn merge_whole(&self) {
        let merged = self.merge().unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(merged.missing, Default::default());
        assert!(
            merged.notes.is_empty() && merged.outcome.failures.is_empty(),
            "{:?}",
            merged.notes
        );
        assert_like_whole(&self.dir(), &self.plan);
    }

    fn sessions(&self) -> Vec<serde_json::Value> {
        let value: serde_json::Value =
            serde_json::from_slice(&read(self.dir().join("provenance.json"))).unwrap();
        value["sessions"].as_array().unwrap().clone()
    }
}

fn log(device: &'static str) -> Rc<RefCell<Log>> {
    Rc::new(RefCell::new(Log {
        device: Some(device),
        ..Log::default()
    }))
}

#[test]
fn a_merge_equals_the_run_of_one_process_for_any_count_and_order() {
    let mut random = fastrand::Rng::with_seed(1);
    for count in [1, 2, 3, 5, 40] {
        let bench = Bench::new(EXPERIMENT);
        let mut references = 0;
        let mut order: Vec<usize> = (0..count).collect();
        random.shuffle(&mut order);
        for index in order {
            let shard = format!("{}/{count}", index + 1);
            let log = log("fake");
            bench.shard(&shard, &log).unwrap();
            references += log
                .borrow()
                .renders
                .iter()
                .filter(|(method, _)| method == "reference")
                .count();
            assert_eq!(bench.done(&shard), 0, "what is done is not done again");
            assert!(!bench.dir().join("errors.csv").exists());
        }
        assert_eq!(
            references, REFERENCES,
            "{count}: each reference is rendered once"
        );
        bench.merge_whole();
        let at_work = split(&bench.plan, count)
            .iter()
            .filter(|share| share.cells.len() + share.timings.len() > 0)
            .count();
        assert_eq!(bench.sessions().len(), at_work);
        assert!(
            bench.sessions()[0]["shard"]
                .as_str()
                .unwrap()
                .ends_with(&format!("/{count}"))
        );
        let before = contents(&bench.dir());
        bench.merge().unwrap();
        assert!(
            contents(&bench.dir()) == before,
            "a second merge changes nothing"
        );
    }
}

/// Unfinished work of others: a killed shard, another number of shards, an ordinary run.
#[test]
fn killed_shards_are_repeated_and_anything_may_end_the_run() {
    for renders in [0, 1, 3, 7, 12] {
        let bench = Bench::new(EXPERIMENT);
        let lost = log("fake");
        lost.borrow_mut().renders_left = Some(renders);
        assert!(matches!(
            bench.shard("2/3", &lost),
            Err(RunError::DeviceLost(_))
        ));
        let missing = bench.merge().unwrap().missing;
        let timings = timing::jobs(&bench.plan).len();
        assert!(
            missing.cells.len() + renders * 2 >= 64 && missing.timings == timings,
            "{missing:?}"
        );
        let shards: Vec<String> = missing
            .shards
            .iter()
            .map(|(shard, end)| format!("{shard} {end}"))
            .collect();
        assert!(
            shards[0] == "1/3 never started" && shards[2] == "3/3 never started",
            "{shards:?}"
        );
        assert!(
            shards[1].starts_with("2/3 started on ") && shards[1].ends_with("ended early"),
            "{shards:?}"
        );
        // Of several sessions the last one counts.
        let path = bench.dir().join("shards/2-of-3.json");
        let mut record: serde_json::Value = serde_json::from_slice(&read(&path)).unwrap();
        let first = serde_json::json!({ "wall_s": "unknown" });
        record["sessions"].as_array_mut().unwrap().insert(0, first);
        std::fs::write(&path, record.to_string()).unwrap();
        assert!(
            bench.merge().unwrap().missing.shards[1]
                .1
                .ends_with("ended early")
        );
        bench.done("2/3");
        bench.done("3/3");
        let missing = bench.merge().unwrap().missing;
        assert_eq!(
            missing.shards,
            [(Shard { index: 1, count: 3 }, "never started".to_owned())]
        );
        assert_eq!(missing.timings, 0);
        match renders {
            0 => assert!(bench.done("1/3") > 0),
            1 => assert!(super::runs::finished(&bench.plan, &bench.dir()).exists()),
            _ => assert!(bench.all_done(&["4/4", "1/4", "3/4", "2/4"]) > 0),
        }
        bench.merge_whole();
    }
}

/// Each fault is named with its path, and nothing is written; running its shard again repairs it.
#[test]
fn damaged_records_and_images_are_found_before_anything_is_written() {
    let bench = Bench::new(EXPERIMENT);
    bench.all_done(&["1/2", "2/2"]);
    let files = |folder: &str, end: &str| -> Vec<PathBuf> {
        let names = contents(&bench.dir().join(folder))
            .into_keys()
            .filter(|name| name.ends_with(end));
        names
            .map(|name| bench.dir().join(folder).join(name))
            .collect()
    };
    let cut = |path: &Path| std::fs::write(path, &read(path)[..40]).unwrap();
    let change = |path: &Path| {
        let mut bytes = read(path);
        let place = bytes.iter().rposition(u8::is_ascii_digit).unwrap();
        bytes[place] ^= 1;
        std::fs::write(path, bytes).unwrap();
    };
    let remove = |path: &Path| std::fs::remove_file(path).unwrap();
    let image = "differs from its record";
    type Damage<'a> = &'a dyn Fn(&Path);
    let damages: [(&str, &str, Damage, &str); 11] = [
        ("cells", ".json", &cut, "delete the file to regenerate it"),
        ("cells", ".json", &change, "its checksum is wrong"),
        ("timings", ".json", &cut, "delete the file to regenerate it"),
        ("timings", ".json", &change, "its checksum is wrong"),
        ("references", ".json", &change, "its checksum is wrong"),
        ("images", ".exr", &cut, image),
        ("images", ".exr", &change, image),
        ("images", ".exr", &remove, "is missing"),
        ("images", ".error.png", &change, image),
        ("images", ".flip.png", &remove, "is missing"),
        ("images", "1.png", &change, image),
    ];
    for (folder, end, damage, what) in damages {
        let path = files(folder, end).remove(1);
        let whole = read(&path);
        damage(&path);
        let before = contents(&bench.dir());
        let error = bench.merge().unwrap_err();
        let text = error.to_string();
        assert!(matches!(error, RunError::Damaged(_)), "{text}");
        assert!(
            text.contains(&path.display().to_string()) && text.contains(what),
            "{what}: {text}"
        );
        assert!(
            contents(&bench.dir()) == before,
            "{what}: something was written"
        );
        match folder {
            // Only unfinished cells need a reference.
            "references" => std::fs::write(&path, whole).unwrap(),
            _ => assert!(bench.all_done(&["1/2", "2/2"]) <= 6, "{what}"),
        }
    }
    bench.merge_whole();
}

#[test]
fn every_cell_is_in_one_part_and_parts_have_no_image_in_common() {
    let plain = EXPERIMENT.split("[timing]").next().unwrap();
    let dear = EXPERIMENT.replace("rounds = 6", "rounds = 60000");
    for text in [EXPERIMENT, plain, &dear] {
        let plan = plan(text);
        let jobs: BTreeSet<Id> = timing::jobs(&plan).into_iter().map(|job| job.id).collect();
        let cells: BTreeMap<Id, _> = plan.cells.iter().map(|cell| (cell.id, cell)).collect();
        let seconds = |share: &Share| {
            let jobs = timing::jobs(&plan);
            let mut steps = Steps::new(&plan, &jobs, []);
            let timed = jobs
                .iter()
                .filter(|job| share.timings.contains(&job.id))
                .map(|job| steps.timing(job))
                .sum();
            (
                share.cells.iter().map(|id| steps.cell(cells[id])).sum(),
                timed,
            )
        };
        let (all, timed): (f64, f64) = seconds(&split(&plan, 1)[0]);
        let unit = |group: &ReferenceGroup| {
            let cells = group.cells().map(|cell| cell.id).collect();
            seconds(&Share {
                cells,
                ..Share::default()
            })
            .0
        };
        let largest = plan.groups().iter().map(unit).fold(0.0, f64::max);
        for count in [1, 2, 3, 4, 7, 64, 100] {
            let shares = split(&plan, count);
            assert_eq!(shares, split(&self::plan(text), count));
            assert_eq!(
                shares.iter().map(|share| share.cells.len()).sum::<usize>(),
                plan.cells.len()
            );
            let found: BTreeSet<&Id> = shares.iter().flat_map(|share| &share.cells).collect();
            assert_eq!(
                found.len(),
                plan.cells.len(),
                "{count}: a cell is in two parts"
            );
            let of: Vec<&Share> = shares
                .iter()
                .filter(|share| !share.timings.is_empty())
                .collect();
            assert!(if jobs.is_empty() {
                of.is_empty()
            } else {
                of.len() == 1 && of[0].timings == jobs
            });
            let mut owner: BTreeMap<Id, usize> = BTreeMap::new();
            for (place, share) in shares.iter().enumerate() {
                for id in &share.cells {
                    let cell = cells[id];
                    for image in cell.reference.into_iter().chain([cell.radiance]) {
                        assert_eq!(
                            *owner.entry(image).or_insert(place),
                            place,
                            "{count}: {image} is in two parts"
                        );
                    }
                }
            }
            // A part may end in the middle of a unit, and the tables of the last unit may be made
            // twice.
            let due = if timed * count as f64 >= all + timed {
                all / (count - 1).max(1) as f64
            } else {
                (all + timed) / count as f64
            };
            for share in &shares {
                let (own, timed) = seconds(share);
                let own = if share.cells.is_empty() {
                    0.0
                } else {
                    own + timed
                };
                assert!(own <= due + 2.0 * largest, "{count}: {own} s of {due} s");
            }
        }
    }
}

#[test]
fn as_many_parts_as_references_hold_one_each() {
    let plan = plan(
        "name = \"even\"\nreference = { samples = 32, noise_share = 0 }\n[axes]\nmethod = [\"sampled\"]\nf0 = [0.1, \
         0.2, 0.3, 0.4]\n",
    );
    let sizes = |count| {
        split(&plan, count)
            .iter()
            .map(|share| share.cells.len())
            .collect::<Vec<_>>()
    };
    assert_eq!(
        (sizes(4), sizes(3)),
        (vec![1; 4], vec![1, 2, 1]),
        "a unit is where its middle is"
    );
}

#[test]
fn a_second_process_for_the_same_cells_is_refused() {
    let bench = Bench::new(EXPERIMENT);
    let open = |shard: &str| Store::open_shard(&bench.dir(), &bench.plan, shard.parse().unwrap());
    let held = [open("1/3").unwrap(), open("2/3").unwrap()];
    let busy = |error: RunError, who: &str| {
        assert!(
            matches!(&error, RunError::Store(fault) if fault.is_passing()),
            "{error}"
        );
        assert!(
            error.to_string().contains(&format!("{who} is using it")),
            "{error}"
        );
    };
    busy(bench.shard("2/3", &log("fake")).unwrap_err(), "shard 2/3");
    busy(bench.shard("1/2", &log("fake")).unwrap_err(), "shard 1/3");
    busy(
        super::runs::invoke(&bench.plan, &bench.dir(), &log("fake"), 1).unwrap_err(),
        "another run",
    );
    bench.done("3/3");
    busy(bench.merge().unwrap_err(), "another run");
    drop(held);
    bench.all_done(&["1/3", "2/3"]);
    bench.merge_whole();
    let whole = Store::open(&bench.dir(), &bench.plan).unwrap();
    busy(bench.shard("1/3", &log("fake")).unwrap_err(), "another run");
    drop(whole);
}

#[test]
fn a_mix_of_devices_is_reported_and_failures_are_kept() {
    let bench = Bench::new(EXPERIMENT);
    let broken = log("rare");
    broken.borrow_mut().broken_method = Some("split-sum");
    let failures = bench.shard("1/3", &broken).unwrap().failures.len();
    assert!(failures > 0);
    ["2/3", "3/3"].iter().for_each(|shard| {
        assert!(
            bench
                .shard(shard, &log("usual"))
                .unwrap()
                .failures
                .is_empty()
        )
    });
    let merged = bench.merge().unwrap();
    assert_eq!(
        (merged.outcome.failures.len(), merged.missing.cells.len()),
        (failures, 0)
    );
    assert!(
        merged
            .outcome
            .failures
            .iter()
            .all(|failure| failure.reason == "the shader is broken")
    );
    let shares = split(&bench.plan, 3);
    let (cells, usual) = (
        shares[0].cells.len() - failures,
        shares[1].cells.len() + shares[2].cells.len(),
    );
    let note = format!(
        "the cells come from 2 devices: {cells} from rare (formula), {usual} from usual (formula)"
    );
    assert_eq!(merged.notes, [note]);
}

/// The name of a software device states a vector width, but not which instructions it has.
#[test]
fn processors_under_one_device_name_are_a_mix() {
    let bench = Bench::new(EXPERIMENT);
    let targets = [
        "core, features 11",
        "core, features 22",
        "core, features 22",
    ];
    for (shard, target) in ["1/3", "2/3", "3/3"].into_iter().zip(targets) {
        let log = log("soft");
        log.borrow_mut().target = Some(target);
        assert!(bench.shard(shard, &log).unwrap().failures.is_empty());
    }
    let shares = split(&bench.plan, 3);
    let note = format!(
        "the cells come from 2 devices: {} from soft (formula; core, features 11), {} from soft \
         (formula; core, features 22)",
        shares[0].cells.len(),
        shares[1].cells.len() + shares[2].cells.len()
    );
    assert_eq!(bench.merge().unwrap().notes, [note]);
}

#[test]
fn shards_go_on_from_a_smaller_plan_and_refuse_to_lose_cells() {
    let small = plan(&EXPERIMENT.replace("[1, 4, 16]", "[4, 16]"));
    let bench = Bench::new(EXPERIMENT);
    super::runs::finished(&small, &bench.dir());
    assert_eq!(bench.all_done(&["2/2", "1/2"]), REFERENCES);
    bench.merge_whole();
    let before = contents(&bench.dir());
    let smaller = Bench {
        plan: small,
        root: bench.root,
    };
    let error = smaller.shard("1/2", &log("fake")).unwrap_err().to_string();
    assert!(
        error.contains("16 finished cells are not in tiny.toml"),
        "{error}"
    );
    assert!(contents(&smaller.dir()) == before);
    let nothing = Bench::new(EXPERIMENT);
    assert!(
        nothing
            .merge()
            .unwrap_err()
            .to_string()
            .contains("contains no run")
    );
    assert!(!nothing.dir().exists());
}
