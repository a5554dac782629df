//! What the rest of a run is said to cost: lines through known costs, speeds from records that hold known times, and the sources named.

use super::run::EXPERIMENT;
use super::runs::{fakes, finished, log, plan, rewrite};
use splitsum::runner::estimate::{
    Amount, Estimate, Host, Part, REPORT_BYTES_MAX, Source, Speeds, amount, constants, estimate, items, lack, probe,
    recorded,
};
use splitsum::runner::{Cell, Plan, timing};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// f64 arithmetic of small sums and a 2x2 system.
const F64: f64 = 1e-9;

fn of(pixels: f64, samples: f64) -> Amount {
    Amount { pixels, samples }
}

#[test]
fn a_line_goes_through_costs_that_are_one_and_is_never_negative() {
    let cost = |pixels: f64, samples: f64| 3e-8 * pixels + 2e-9 * samples;
    let images = [(1e4, 1e4), (1e4, 4e5), (4e4, 4e4), (4e4, 1e7)];
    let measured: Vec<_> =
        images.iter().map(|&(p, s)| ("image sampled ggx".to_owned(), of(p, s), cost(p, s))).collect();
    let line = *Speeds::fit(&measured).line("image sampled ggx").unwrap();
    assert!((line.per_pixel / 3e-8 - 1.0).abs() < F64 && (line.per_sample / 2e-9 - 1.0).abs() < F64, "{line:?}");
    // One sample count alone tells one slope; a table has no pixels.
    let one = Speeds::fit(&[("a".to_owned(), of(1e4, 1e6), 0.5), ("b".to_owned(), of(0.0, 1e6), 0.25)]);
    assert!((one.line("a").unwrap().at(of(1e4, 2e6)) - 1.0).abs() < F64);
    assert!((one.line("b").unwrap().at(of(0.0, 4e6)) - 1.0).abs() < F64);
    // More samples in less time is noise, not a gain.
    let noise = Speeds::fit(&[("a".to_owned(), of(1e4, 1e4), 0.2), ("a".to_owned(), of(1e4, 1e5), 0.1)]);
    let line = noise.line("a").unwrap();
    assert!(line.per_pixel >= 0.0 && line.per_sample >= 0.0 && line.at(of(1e4, 1e4)) > 0.0, "{line:?}");
}

#[test]
fn a_kind_that_was_not_measured_is_taken_for_its_like_but_never_for_another_method() {
    let measured = ["image sampled sh9 ggx", "image sampled sh9 phong", "image split-sum sh9 ggx"];
    let seconds = [1.0, 3.0, 0.1];
    let measured: Vec<_> = measured.iter().zip(seconds).map(|(kind, s)| (kind.to_string(), of(1.0, 1.0), s)).collect();
    let speeds = Speeds::fit(&measured);
    let at = |kind: &str| speeds.line(kind).map(|line| line.at(of(1.0, 1.0)));
    assert!((at("image sampled sh9 phong").unwrap() - 3.0).abs() < F64);
    let between = at("image sampled sh9 beckmann").unwrap();
    assert!(between > 1.0 && between < 3.0, "{between}");
    assert_eq!(at("image sampled-unfiltered sh9 ggx"), None);
    assert!(constants().line("image anything at all").is_some());
}

fn sweep(alpha: &str) -> Plan {
    plan(&EXPERIMENT.replace("0.1, 0.5", alpha))
}

fn of_open(plan: &Plan, sources: &[(Source, Speeds)], host: Host) -> Estimate {
    let cells: Vec<&Cell> = plan.cells.iter().collect();
    let jobs = timing::jobs(plan);
    estimate(plan, &cells, &items(plan, &cells, &jobs, &BTreeSet::new()), sources, host)
}

/// Seconds that the made-up records give an image, a reference, a first and a further score.
fn made_up_s(kind: &str, samples: f64) -> f64 {
    match kind {
        "image" => 1e-6 * samples,
        "reference" => 3e-6 * samples,
        "first" => 0.5,
        _ => 0.125,
    }
}

/// A finished run whose records say what [`made_up_s`] does.
fn made_up(dir: &Path) -> PathBuf {
    let plan = sweep("0.1");
    let run = finished(&plan, &dir.join("earlier"));
    for cell in &plan.cells {
        rewrite(&run.join(format!("cells/{}.json", cell.id)), |record| {
            let is_first = !record["spent"]["image_ms"].is_null();
            let has_reference = !record["spent"]["reference_ms"].is_null();
            let mut set = |name: &str, kind: &str, samples: f64| {
                record["spent"][name] = (1e3 * made_up_s(kind, samples)).into();
            };
            set("score_ms", if is_first { "first" } else { "again" }, 0.0);
            if is_first {
                set("image_ms", "image", amount(&plan, &cell.point).samples);
            }
            if has_reference {
                set("reference_ms", "reference", amount(&plan, &plan.reference_point(&cell.point)).samples);
            }
            record["spent"]["display_ms"] = 0.0.into();
        });
    }
    run
}

#[test]
fn records_of_an_earlier_run_price_other_cells_of_the_experiment() {
    let dir = tempfile::tempdir().unwrap();
    let run = made_up(dir.path());
    let plan = sweep("0.3, 0.6");
    let found = recorded(&plan, std::slice::from_ref(&run), None);
    assert_eq!(found.count, 16);
    let host = Host { threads: 2, is_cpu_device: true };
    let got = of_open(&plan, &[(Source::Records, found.speeds), (Source::Constants, constants())], host);
    let pixels = 24.0 * 24.0;
    // Two models and two alphas: 1, 4 and 16 samples and one of split-sum; a reference of 64 samples for each term.
    let expected = [
        (Part::Images, 16.0, 4.0 * made_up_s("image", pixels * (1.0 + 4.0 + 16.0 + 1.0))),
        (Part::Scores, 32.0, 16.0 * (made_up_s("first", 0.0) + made_up_s("again", 0.0)) / 2.0),
    ];
    for (part, count, seconds) in expected {
        let found = &got.parts[&part];
        assert_eq!(found.count, count, "{part:?}");
        assert!((found.seconds / seconds - 1.0).abs() < 1e-6, "{part:?}: {} for {seconds}", found.seconds);
        assert_eq!(found.sources.keys().collect::<Vec<_>>(), [&Source::Records], "{part:?}");
    }
    let references = &got.parts[&Part::References];
    let samples: f64 = amount(&plan, &plan.reference_point(&plan.cells[0].point)).samples;
    assert!((references.seconds / (4.0 * made_up_s("reference", samples)) - 1.0).abs() < 1e-6, "{references:?}");
    assert_eq!(got.bytes_source, Some(Source::Records));
    let files: u64 = std::fs::read_dir(run.join("images")).unwrap().map(|e| e.unwrap().metadata().unwrap().len()).sum();
    // The same images again, at twice as many alphas.
    let ratio = got.bytes / (2.0 * files as f64);
    assert!((1.0..4.0).contains(&ratio), "{ratio}: images, records and tables beside them");
    assert_eq!(REPORT_BYTES_MAX, splitsum::study::page::images::BUDGET_BYTES);

    // Made on another device: they say nothing here.
    let mut other = splitsum::runner::Renderer::device(&*fakes(&log())().unwrap());
    assert_eq!(recorded(&plan, std::slice::from_ref(&run), Some(&other)).count, 16);
    other.driver = "another".to_owned();
    assert_eq!(recorded(&plan, &[run], Some(&other)).count, 0);
}

#[test]
fn without_records_every_part_is_a_guess_and_called_so() {
    let plan = plan(&format!("{}[timing]\nwarmup = 2\nrounds = 5\n", EXPERIMENT.replace("0.1, 0.5", "0.1")));
    let (empty, cells) = (Speeds::default(), plan.cells.iter().collect::<Vec<&Cell>>());
    let jobs = timing::jobs(&plan);
    let work = items(&plan, &cells, &jobs, &BTreeSet::new());
    assert!(lack(&empty, &work) && !lack(&constants(), &work));
    let got = of_open(
        &plan,
        &[(Source::Records, empty), (Source::Constants, constants())],
        Host { threads: 2, is_cpu_device: true },
    );
    for (part, found) in &got.parts {
        assert_eq!(found.sources.keys().collect::<Vec<_>>(), [&Source::Constants], "{part:?}");
    }
    assert!(Source::Constants.name().contains("guess"));
    // Four configurations of two models: two frames of warm-up, five that count and five after a change; the tables of two methods seven times each.
    let frames = 8.0 * 12.0;
    assert!(
        got.parts[&Part::Timing].count > frames && got.parts[&Part::Timing].seconds > 0.0,
        "{:?}",
        got.parts[&Part::Timing]
    );
    // A reference that a cache holds is not work.
    let kept: BTreeSet<&str> = plan.cells.iter().map(|cell| cell.reference.as_str()).collect();
    assert!(items(&plan, &cells, &jobs, &kept).iter().all(|item| item.part != Part::References));
}

/// A GPU renders while the processors score; a software driver shares them.
#[test]
fn scores_cost_beside_a_gpu_only_what_exceeds_it() {
    let plan = sweep("0.1");
    let speeds = |image: f64, score: f64| {
        let measured =
            [("image sampled", image), ("image split-sum", image), ("score first", score), ("score again", score)];
        let amount_of = |kind: &str| of(576.0, if kind.starts_with("image") { 576.0 } else { 0.0 });
        let measured: Vec<_> = measured.iter().map(|(kind, s)| (kind.to_string(), amount_of(kind), *s)).collect();
        vec![(Source::Probe, Speeds::fit(&measured)), (Source::Constants, constants())]
    };
    let seconds = |image: f64, score: f64, is_cpu_device: bool| {
        let got = of_open(&plan, &speeds(image, score), Host { threads: 4, is_cpu_device });
        let part = |part: Part| got.parts[&part].seconds;
        (got.seconds - part(Part::Ends), part(Part::Scores), got.seconds)
    };
    let (gpu, scores, _) = seconds(10.0, 0.1, false);
    let (cpu, ..) = seconds(10.0, 0.1, true);
    assert!((cpu - gpu - scores).abs() < F64, "{cpu} {gpu} {scores}");
    let (gpu, scores, _) = seconds(1e-9, 100.0, false);
    assert!((gpu - scores).abs() < 1e-6 * scores, "{gpu} {scores}");
}

#[test]
fn a_probe_knows_every_kind_of_work_of_its_plan() {
    let plan = plan(&format!("{}[timing]\nwarmup = 2\nrounds = 5\n", EXPERIMENT.replace("0.1, 0.5", "0.1, 0.4")));
    let log = log();
    let mut renderer = fakes(&log)().unwrap();
    let speeds = probe(&plan, renderer.as_mut(), 0.25).unwrap();
    assert!(speeds.line("start").unwrap().fixed >= 0.25);
    let cells: Vec<&Cell> = plan.cells.iter().collect();
    let work = items(&plan, &cells, &timing::jobs(&plan), &BTreeSet::new());
    // The fake has times for the DFG table only.
    let known: Vec<_> =
        work.into_iter().filter(|item| item.part != Part::Tables && !item.kind.starts_with("table")).collect();
    assert!(!lack(&speeds, &known));
    assert!(log.borrow().renders.iter().all(|(_, samples)| *samples <= 64), "{:?}", log.borrow().renders);
    // As the cache keeps it.
    let kept: Speeds = serde_json::from_slice(&serde_json::to_vec(&speeds).unwrap()).unwrap();
    for kind in ["image sampled sh9 ggx", "score first", "reference", "bytes linear", "start"] {
        let at = |speeds: &Speeds| speeds.line(kind).map(|line| line.at(of(1e4, 1e5)));
        assert_eq!(at(&kept).is_some(), at(&speeds).is_some(), "{kind}");
        assert!(at(&kept).zip(at(&speeds)).is_none_or(|(a, b)| (a / b - 1.0).abs() < F64), "{kind}");
    }
}
