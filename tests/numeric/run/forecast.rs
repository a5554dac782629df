//! The predicted time of a run, with a synthetic clock.

use super::runs::{Bench, Each, fakes, log, options, plan};
use super::timing_ratios::record;
use super::whole::EXPERIMENT;
use fastrand::Rng;
use splitsum::experiment::{Cell, Plan};
use splitsum::run::estimate::{Forecast, Host, Steps, Work};
use splitsum::run::store::Spent;
use splitsum::run::timing::{self, TimingJob, TimingRecord};
use splitsum::run::{MakeRenderer, run};
use std::sync::atomic::AtomicBool;

/// Cells in order of increasing cost; the most expensive takes a thousand times as long as the cheapest.
const SWEEP: &str = r#"
name = "sweep"
reference = { samples = 4096 }
[axes]
environment = ["builtin:sky", "builtin:studio", "builtin:constant"]
alpha = { linspace = [0.1, 1.0, 6] }
brdf = ["ggx", "beckmann", "phong"]
method = ["sampled", "split-sum"]
samples = [1, 16, 256, 1024]
exposure = [1, 4]
"#;
const TIMED: &str = "[timing]\nrounds = 40\nwarmup = 2\n";
const THREADS: f64 = 2.0;

/// Real duration of work that is stated to take a second.
type Truth = fn(kind: &str) -> f64;

/// The remaining seconds of a run after each of its steps, and the predicted ones, starting before the first step.
fn simulated(plan: &Plan, truth: Truth, is_cpu_device: bool) -> Vec<[f64; 2]> {
    let jobs = timing::jobs(plan);
    let cells: Vec<&Cell> =
        plan.groups().iter().flat_map(|group| group.radiances.iter().flat_map(|(_, cells)| cells.clone())).collect();
    let host = Host { threads: THREADS as usize, is_cpu_device };
    let mut forecast = Forecast::new(plan, &cells, &jobs, [], host);
    let (mut steps, mut random) = (Steps::new(plan, &jobs, []), Rng::with_seed(7));
    // Within a fifth of the kind's usual time.
    let mut jitter = || 0.8 + 0.4 * random.f64();
    let taken = |work: &Work, jitter: f64, kind: &str| -> f64 {
        let own = work.0.iter().filter(|(name, _)| name.starts_with(kind));
        own.map(|(name, [_, stated])| stated * truth(name) * jitter).sum()
    };
    let mut clock = vec![0.0];
    let mut said = vec![forecast.ahead(0.0)];
    let mut end = 0.0;
    for cell in &cells {
        let (work, jitter) = (steps.cell(cell), jitter());
        let ms = |kind: &str| Some(1e3 * taken(&work, jitter, kind)).filter(|ms| *ms > 0.0);
        let tables = ["mips", "prefilter", "dfg", "sh9", "irradiance"];
        let of_table = |name: &&str| Some((name.to_string(), ms(&format!("table {name}"))?));
        let spent = Spent {
            image_ms: ms("image"),
            reference_ms: ms("reference"),
            ladder_ms: None,
            tables_ms: tables.iter().filter_map(of_table).collect(),
            display_ms: ms("display").unwrap_or(0.0),
            score_ms: ms("host score").unwrap_or(0.0),
        };
        let device: f64 =
            ["image", "reference", "table", "display"].iter().map(|kind| taken(&work, jitter, kind)).sum();
        let beside = taken(&work, jitter, "host score") / THREADS;
        clock.push(clock[clock.len() - 1] + if is_cpu_device { device + beside } else { device.max(beside) });
        end += taken(&work, 1.0, "host end");
        forecast.cell(cell, Some(&spent));
        said.push(forecast.ahead(clock[clock.len() - 1]));
    }
    for job in &jobs {
        let (work, jitter) = (steps.timing(job), jitter());
        clock.push(clock[clock.len() - 1] + taken(&work, jitter, "timed"));
        let counted: f64 = work.0.values().map(|[count, _]| count).sum::<f64>() / work.0.len() as f64;
        forecast.timing(job, Some(&timed(job, 1e3 * taken(&work, jitter, "timed") / counted)));
        said.push(forecast.ahead(clock[clock.len() - 1]));
    }
    let total = clock[clock.len() - 1] + end;
    clock.iter().zip(said).map(|(clock, ahead)| [total - clock, ahead.seconds]).collect()
}

/// The record of a configuration whose frames take `ms`.
fn timed(job: &TimingJob, ms: f64) -> TimingRecord {
    TimingRecord {
        cell: job.cell.id.clone(),
        block: job.block.clone(),
        environment_size: job.environment_size,
        size: job.size,
        axes: job.axes.clone(),
        wall_ms: vec![ms; 3],
        ..record(job.phase, &[], &[])
    }
}

/// The largest factor between remaining and predicted time, from a tenth of the time on and before its last hundredth.
fn worst(found: &[[f64; 2]]) -> f64 {
    let total = found[0][0];
    let judged = found.iter().filter(|[left, _]| *left <= 0.9 * total && *left >= 0.01 * total);
    judged.map(|[left, said]| (said / left).max(left / said)).fold(1.0, f64::max)
}

#[test]
fn a_prediction_is_right_within_a_factor_of_one_and_a_half_after_a_tenth_of_the_work() {
    let truths: [(&str, Truth, bool); 6] = [
        ("as stated", |_| 1.0, true),
        ("five times slower", |_| 5.0, true),
        ("ten times faster", |_| 0.1, true),
        ("references end early", |kind| if kind.starts_with("reference") { 0.05 } else { 1.0 }, true),
        ("a fast GPU", |kind| if kind.starts_with("host") { 1.0 } else { 0.004 }, false),
        ("one method is dear", |kind| if kind.ends_with("split-sum") { 3.0 } else { 1.0 }, true),
    ];
    for text in [SWEEP.to_owned(), format!("{SWEEP}{TIMED}")] {
        let plan = plan(&text);
        for (name, truth, is_cpu_device) in truths {
            let factor = worst(&simulated(&plan, truth, is_cpu_device));
            assert!(factor <= 1.5, "{name}: {factor}");
        }
    }
}

#[test]
fn shared_work_counts_once_and_kept_references_not_at_all() {
    let plan = plan(EXPERIMENT);
    let cells: Vec<&Cell> = plan.cells.iter().collect();
    let count = |kept: Vec<String>, word: &str| {
        let host = Host { threads: 2, is_cpu_device: true };
        let forecast = Forecast::new(&plan, &cells, &[], kept, host);
        forecast.parts().into_iter().find(|(name, ..)| *name == word).map_or(0.0, |(_, count, _)| count)
    };
    // Two models and two alphas, each with a reference, three sample counts and split-sum; two exposures share them.
    let none = Vec::new;
    assert_eq!(["references", "images", "scores and files"].map(|part| count(none(), part)), [4.0, 16.0, 32.0]);
    let kept = || plan.cells.iter().map(|cell| cell.reference.clone()).collect();
    assert_eq!([count(kept(), "references"), count(kept(), "images")], [0.0, 16.0]);
}

#[test]
fn a_run_predicts_its_time() {
    let bench = Bench::new(&format!("{EXPERIMENT}[timing]\nwarmup = 1\nrounds = 3\n"));
    let stop = AtomicBool::new(false);
    let options = options(bench.dir.path(), &stop);
    let mut shares = Vec::new();
    let mut progress = Each(|_: &str, ahead| shares.push(ahead));
    run(&bench.plan, &mut fakes(&log()) as &mut MakeRenderer, &options, &mut progress).unwrap();
    assert_eq!(shares.len(), 1 + 32 + 12);
    assert!(shares[0].share == 0.0 && shares[0].seconds > 0.0);
    // Tables and pages remain.
    let last = shares[shares.len() - 1];
    assert!((0.5..1.0).contains(&last.share) && last.seconds > 0.0, "{last:?}");
}
