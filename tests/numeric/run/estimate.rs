//! What the rest of a run is said to cost: lines through known costs, speeds from records that hold known times, and the sources named.

use super::runs::{fakes, finished, log, plan, rewrite};
use super::whole::EXPERIMENT;
use splitsum::experiment::{Cell, Plan};
use splitsum::run::estimate::{
    Amount, Estimate, Host, Part, REPORT_BYTES_MAX, SAMPLES_PER_SECOND, Source, Speeds, amount, constants,
    device_speeds, estimate, items, lack, recorded, samples_per_second,
};
use splitsum::run::timing;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// f64 arithmetic of small sums and a 2x2 system.
const F64: f64 = 1e-9;

fn of(pixels: f64, samples: f64) -> Amount {
    Amount { pixels, samples }
}

#[test]
fn measurements_scale_the_kinds_that_they_are_of_and_their_likes_alone() {
    let kinds = ["image sampled sh9 ggx", "image sampled sh9 phong", "image split-sum sh9 ggx"];
    let (small, large) = (of(1e4, 4e5), of(4e4, 1e7));
    let stated = |kind: &str, amount: Amount| constants().line(kind).unwrap().at(amount);
    // Twice, four times and half of what is stated, at two sizes.
    let factors = [2.0, 4.0, 0.5];
    let measured: Vec<_> = kinds
        .iter()
        .zip(factors)
        .flat_map(|(kind, factor)| [small, large].map(|size| (kind.to_string(), size, factor * stated(kind, size))))
        .collect();
    let speeds = constants().scaled_to(&measured);
    let factor = |kind: &str| speeds.line(kind).map(|line| line.at(large) / stated(kind, large));
    for (kind, expected) in kinds.iter().zip(factors) {
        assert!((factor(kind).unwrap() / expected - 1.0).abs() < F64, "{kind}");
    }
    // A model that was not measured is between those that were; another method is unknown; a timed frame is reckoned as an image.
    assert!((factor("image sampled sh9 beckmann").unwrap() / 3.0 - 1.0).abs() < F64);
    assert_eq!(factor("image sampled-unfiltered sh9 ggx"), None);
    assert!((factor("frame sampled sh9 phong").unwrap() / 4.0 - 1.0).abs() < F64);
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
    let (speeds, count) = recorded(&plan, std::slice::from_ref(&run), None);
    assert_eq!(count, 16);
    let host = Host { threads: 2, is_cpu_device: true };
    let got = of_open(&plan, &[(Source::Records, speeds), (Source::Constants, constants())], host);
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
    assert_eq!(REPORT_BYTES_MAX, splitsum::report::page::images::BUDGET_BYTES);

    // Made on another device: they say nothing here.
    let mut other = splitsum::run::Renderer::device(&*fakes(&log())().unwrap());
    assert_eq!(recorded(&plan, std::slice::from_ref(&run), Some(&other)).1, 16);
    other.driver = "another".to_owned();
    assert_eq!(recorded(&plan, &[run], Some(&other)).1, 0);
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
        vec![(Source::Probe, constants().scaled_to(&measured)), (Source::Constants, constants())]
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
fn a_probe_scales_the_work_of_the_device_and_nothing_else() {
    let plan = sweep("0.1, 0.4");
    let log = log();
    let rate = samples_per_second(&plan, fakes(&log)().unwrap().as_mut()).unwrap().unwrap();
    assert!(rate.is_finite() && rate > 0.0);
    assert!(log.borrow().renders.iter().all(|(method, samples)| method == "sampled" && *samples <= 64));
    let (twice, stated) = (device_speeds(2.0 * SAMPLES_PER_SECOND), constants());
    let at = |speeds: &Speeds, kind: &str| speeds.line(kind).map(|line| line.at(of(1e4, 1e6)));
    let image = "image sampled none ggx";
    assert!((at(&stated, image).unwrap() / at(&twice, image).unwrap() - 2.0).abs() < F64);
    assert_eq!((at(&twice, "score first"), at(&twice, "bytes linear")), (None, None));
}
