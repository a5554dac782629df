//! What a report says of joined runs, which chart it leads with, and which images fit it.

use crate::runner::runs::{finished, plan};
use splitsum::study::answers::break_even::BreakEven;
use splitsum::study::answers::run_folder::RunFolder;
use splitsum::study::answers::study::Study;
use splitsum::study::report::exclusions::collect as exclusions;
use splitsum::study::report::images::{BUDGET_BYTES, Choice, Window, collect};
use splitsum::study::report::joined::{analysis, each, facts, repeats, warnings};
use splitsum::study::report::lead::{Lead, lead};
use std::path::Path;

fn text(axes: &str, rest: &str) -> String {
    format!("name = \"joined\"\nsize = [24, 24]\nreference = {{ samples = 64 }}\n[axes]\n{axes}\n{rest}\n")
}

const CASES: &str = "environment = [\"builtin:constant\"]\nalpha = [0.1, 0.5]\nmethod = [\"sampled\", \"split-sum\"]\n";

fn run(dir: &Path, name: &str, axes: &str, rest: &str) -> RunFolder {
    RunFolder::read(&finished(&plan(&text(axes, rest)), &dir.join(name))).unwrap()
}

fn labels(runs: &[RunFolder]) -> Vec<String> {
    (0..runs.len()).map(|i| format!("run {i}")).collect()
}

#[test]
fn a_run_joined_with_itself_is_no_more_evidence() {
    let dir = tempfile::tempdir().unwrap();
    let axes = format!("{CASES}samples = [1, 4, 16]\npoint_set = [0, 1, 2]");
    let runs: Vec<RunFolder> = ["a", "b"].map(|name| run(dir.path(), name, &axes, "")).into();
    let names = labels(&runs);
    let alone = &each(&runs[..1], &names[..1])[0];
    let all = each(&runs, &names);
    let both = analysis(&Study::new(&runs, &names), &each(&runs, &names), &runs, &names);
    assert_eq!(both.case_axes, ["run", "alpha"]);
    assert_eq!(both.pairs.iter().map(|pair| pair.run).collect::<Vec<_>>(), [0, 1]);
    for (pair, own) in both.pairs.iter().zip(&all) {
        // The same cases with the same intervals as alone, and so the same words.
        assert_eq!(own.answer, alone.answer);
        let wanted = &alone.answers.pairs[0];
        assert_eq!(pair.pair.cases.len(), wanted.cases.len());
        for (case, wanted) in pair.pair.cases.iter().zip(&wanted.cases) {
            assert_eq!(case.whole, wanted.whole);
            assert!(case.whole.interval.is_some());
            let curve = &both.curves[case.curve];
            assert_eq!(curve.key, case.key);
            assert!(curve.points.iter().all(|point| point.run == pair.run && point.errors.len() == 3));
        }
    }
    let said = repeats(&runs, &names);
    assert_eq!(said.len(), 1, "{said:?}");
    assert!(said[0].contains("run 1 is identical to run 0") && said[0].contains("all 20 cells"), "{said:?}");
}

#[test]
fn each_count_belongs_to_its_own_run() {
    let dir = tempfile::tempdir().unwrap();
    let [few, more] = [("few", "samples = [1, 4]"), ("more", "samples = [1, 4, 16]")]
        .map(|(name, samples)| run(dir.path(), name, &format!("{CASES}{samples}"), ""));
    let runs = vec![few, more];
    let names = labels(&runs);
    let both = analysis(&Study::new(&runs, &names), &each(&runs, &names), &runs, &names);
    let found: Vec<_> =
        both.pairs.iter().map(|pair| (pair.pair.sample_counts.clone(), pair.pair.cases[0].whole.break_even)).collect();
    assert_eq!(found, [(vec![1, 4], BreakEven::Above(4)), (vec![1, 4, 16], BreakEven::From(16))]);
    assert_eq!(repeats(&runs, &names), [""; 0]);
    // What differs comes first; nothing of the list is left out.
    let facts = facts(&runs);
    let fact = |what: &str| facts.iter().find(|fact| fact.what == what).unwrap_or_else(|| panic!("no {what}"));
    for what in ["device", "device type", "driver", "Vulkan", "device memory", "command", "seed"] {
        assert!(!fact(what).differs, "{:?}", fact(what));
    }
    assert!(fact("plan").differs && fact("experiment").differs);
    assert_eq!(fact("cells").values, ["6 of 6 done, 0 failed, 0 excluded", "8 of 8 done, 0 failed, 0 excluded"]);
    assert!(facts.is_sorted_by_key(|fact| !fact.differs));
}

#[test]
fn a_warning_names_the_device_whose_times_say_nothing() {
    let dir = tempfile::tempdir().unwrap();
    let timing = "[timing]\nwarmup = 1\nrounds = 3";
    let mut timed = run(dir.path(), "timed", &format!("{CASES}samples = [1, 4]"), timing);
    assert!(warnings(&timed)[0].contains("The times of fake come from a CPU driver"), "{:?}", warnings(&timed));
    (timed.timings[0].device, timed.timings[0].device_type) = ("card".to_owned(), "discrete".to_owned());
    assert!(warnings(&timed)[0].contains("Those of card do not."), "{:?}", warnings(&timed));
    timed.timings.iter_mut().for_each(|record| record.device_type = "discrete".to_owned());
    assert_eq!(warnings(&timed), [""; 0]);
}

#[test]
fn what_an_experiment_sweeps_chooses_the_chart() {
    let dir = tempfile::tempdir().unwrap();
    let scene = "environment = [\"builtin:constant\"]\nalpha = [0.1, 0.25, 0.5]\n";
    let timing = "[timing]\nwarmup = 1\nrounds = 3";
    let axis = |name: &str| name.to_owned();
    for (i, (axes, rest, wanted)) in [
        ("method = [\"sampled\", \"split-sum\"]\nsamples = [1, 4]", timing, Lead::BreakEven),
        ("method = [\"sampled\", \"split-sum\"]\nsamples = [4]", timing, Lead::Times),
        ("method = [\"sampled\", \"split-sum\"]\nsamples = [1, 4]\nexposure = [1, 2, 4]", "", Lead::Visibility),
        ("method = [\"sampled\", \"split-sum\"]\nsamples = [1, 4, 16]\nexposure = [1, 2]", "", Lead::BreakEven),
        (
            "method = [\"sampled\", \"sampled-unfiltered\"]\nsamples = [1, 4]\nlod_bias = [0, -1, 1]",
            "",
            Lead::Effects { axis: axis("lod_bias") },
        ),
        ("method = [\"sampled\"]\nsamples = [1, 4]\nlod_bias = [0, 1]", "", Lead::Convergence),
        ("method = [\"sampled\"]\nsamples = [4]\nlod_bias = [0, 1]", "", Lead::Effects { axis: axis("lod_bias") }),
        ("method = [\"sampled\", \"sampled-unfiltered\"]\nsamples = [4]", "", Lead::Effects { axis: axis("method") }),
        (
            "method = [\"split-sum\"]\nprefilter_sample_count = [256, 16, 64]",
            "",
            Lead::Effects { axis: axis("prefilter_sample_count") },
        ),
        ("method = [\"split-sum\"]", "", Lead::Sweep { axis: axis("alpha") }),
    ]
    .into_iter()
    .enumerate()
    {
        let runs = [run(dir.path(), &i.to_string(), &format!("{scene}{axes}"), rest)];
        let own = &each(&runs, &labels(&runs))[0];
        assert_eq!(lead(&own.study, &own.answers), wanted, "{axes}");
    }
    // A white furnace is asked for its energy.
    let furnace =
        text(&format!("{scene}method = [\"reference\"]\nf0 = [1]\nalbedo = [1]\nmetallic = [0]\nsamples = [64]"), "")
            .replace("{ samples = 64 }", "{ method = \"none\", samples = 64, terms = \"all\" }");
    let runs = [RunFolder::read(&finished(&plan(&furnace), &dir.path().join("furnace"))).unwrap()];
    let own = &each(&runs, &labels(&runs))[0];
    assert_eq!(lead(&own.study, &own.answers), Lead::Energy);
    let runs = [run(dir.path(), "profile", "environment = [\"builtin:constant\"]\nmethod = [\"split-sum\"]", "")];
    let own = &each(&runs, &labels(&runs))[0];
    assert_eq!(lead(&own.study, &own.answers), Lead::Profile);
}

#[test]
fn exclusions_are_every_combination_that_is_left_out_with_its_reason() {
    let dir = tempfile::tempdir().unwrap();
    let axes = "environment = [\"builtin:constant\"]\nbrdf = [\"ggx\", \"phong\"]\nalpha = [0.1, 0.5]\nmethod = [\"sampled\", \"split-sum\"]\nsamples = [1, 4]";
    let rest = "[[exclude]]\nbrdf = \"phong\"\nalpha = 0.5\nwhy = \"first\"\n[[exclude]]\nbrdf = \"ggx\"\nsamples = 4\nwhy = \"second\"";
    let runs = [run(dir.path(), "run", axes, rest)];
    let names = labels(&runs);
    let found = exclusions(&runs, &names, &Study::new(&runs, &names));
    assert_eq!(found.reasons, ["first", "second"]);
    let place =
        |name: &str| found.axes.iter().position(|axis| axis == name).unwrap_or_else(|| panic!("{:?}", found.axes));
    let told = |(why, values): &(usize, Vec<String>)| {
        (*why, ["brdf", "alpha", "method", "samples"].map(|name| values[place(name)].clone()))
    };
    let mut points: Vec<_> = found.points.iter().map(told).collect();
    points.sort();
    let wanted = [
        (0, ["phong", "0.5", "sampled", "1"]),
        (0, ["phong", "0.5", "sampled", "4"]),
        (0, ["phong", "0.5", "split-sum", ""]),
        (1, ["ggx", "0.1", "sampled", "4"]),
        (1, ["ggx", "0.5", "sampled", "4"]),
    ];
    assert_eq!(points, wanted.map(|(why, values)| (why, values.map(str::to_owned))));
    // They are what the plan is short of: nothing else is missing, nothing is excluded twice.
    assert_eq!(runs[0].errors.rows.len() + points.len(), 2 * 2 * (2 + 1));
}

#[test]
fn of_many_point_sets_the_first_stays_where_not_all_fit() {
    let dir = tempfile::tempdir().unwrap();
    let axes = "environment = [\"builtin:constant\"]\nalpha = [0.5]\nmethod = [\"sampled\", \"split-sum\"]\nsamples = [1, 4]\npoint_set = [3, 1, 2]";
    let runs = [run(dir.path(), "run", axes, "")];
    let bytes = |choice: Choice, budget: usize| {
        let set = collect(&runs, choice, budget).unwrap();
        (set.payloads.iter().map(String::len).sum::<usize>(), set)
    };
    let (all, whole) = bytes(Choice::Automatic, BUDGET_BYTES);
    // A reference, the split sum, two counts of three sets.
    assert_eq!(whole.images.len(), 1 + 1 + 2 * 3);
    assert!(whole.notes.is_empty(), "{:?}", whole.notes);
    let (used, cut) = bytes(Choice::Automatic, all * 3 / 4);
    assert!(
        used <= all * 3 / 4 && cut.notes[0].contains("of several point sets the images of the first"),
        "{:?}",
        cut.notes
    );
    let [cell, set] = ["cell", "point_set"].map(|name| runs[0].errors.column(name).unwrap());
    for row in &runs[0].errors.rows {
        let image = &cut.images[cut.index[&(0, runs[0].images[&row[cell]].radiance.clone())]];
        let is_kept = ["", "3"].contains(&row[set].as_str());
        assert_eq!(image.payload.is_some(), is_kept, "set {:?}", row[set]);
        assert!(!is_kept || image.window.is_some_and(|window| window.width == 24), "{image:?}");
    }
}

#[test]
fn a_crop_leaves_out_the_images_that_end_before_it() {
    let dir = tempfile::tempdir().unwrap();
    let axes =
        "environment = [\"builtin:constant\"]\nalpha = [0.5]\nmethod = [\"split-sum\"]\nsize = [[24, 24], [48, 40]]";
    let text = text(axes, "").replace("size = [24, 24]\nreference", "reference");
    let runs = [RunFolder::read(&finished(&plan(&text), &dir.path().join("run"))).unwrap()];
    let window = Window { x: 20, y: 10, width: 16, height: 12 };
    let set = collect(&runs, Choice::Crop(window), BUDGET_BYTES).unwrap();
    assert_eq!(set.images.len(), 4);
    let [cell, size] = ["cell", "size"].map(|name| runs[0].errors.column(name).unwrap());
    let mut sizes = Vec::new();
    for row in &runs[0].errors.rows {
        for file in [&runs[0].images[&row[cell]].radiance, &runs[0].images[&row[cell]].reference] {
            let image = &set.images[set.index[&(0, file.clone())]];
            let is_large = row[size].starts_with("48");
            assert_eq!(image.window, is_large.then_some(window), "{}", row[size]);
            sizes.push(is_large);
        }
    }
    assert!(sizes.contains(&true) && sizes.contains(&false));
    assert!(set.notes.iter().any(|note| note.contains("2 of 4 images end before the crop does")), "{:?}", set.notes);
    // In none of the sizes: an error that names them all.
    let beyond = Window { x: 40, y: 0, width: 16, height: 8 };
    let error = collect(&runs, Choice::Crop(beyond), BUDGET_BYTES).unwrap_err();
    assert_eq!(error.sizes, "24 x 24 or 48 x 40");
}

#[test]
fn a_folder_is_no_file_to_write() {
    let dir = tempfile::tempdir().unwrap();
    let run = finished(&plan(&text(&format!("{CASES}samples = [1, 4]"), "")), &dir.path().join("run"));
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_splitsum"))
        .args(["report", "--out"])
        .args([dir.path(), &run])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("is a folder; expected the file to write") && said.trim().lines().count() == 1, "{said}");
}
