//! The predicted time of a run, with a synthetic clock.

use super::runs::{Bench, Each, fakes, log, options, plan};
use super::whole::EXPERIMENT;
use fastrand::Rng;
use splitsum::experiment::axis::Point;
use splitsum::experiment::{Cell, Id, Plan};
use splitsum::run::estimate::{Forecast, Steps};
use splitsum::run::timing;
use splitsum::run::{MakeRenderer, run};
use std::sync::atomic::AtomicBool;

/// Cells in order of increasing cost; the most expensive takes a thousand times as long as the
/// cheapest.
const SWEEP: &str = r#"
name = "sweep"
reference = { samples = 4096, noise_share = 0 }
[axes]
environment = ["builtin:sky", "builtin:studio", "builtin:constant"]
alpha = [0.1, 0.25, 0.4, 0.6, 0.8, 1.0]
brdf = ["ggx", "beckmann", "phong"]
method = ["sampled", "split-sum"]
samples = [1, 16, 256, 1024]
exposure = [1, 4]
"#;
const TIMED: &str = "[timing]\nrounds = 40\nwarmup = 2\n";

/// Real over stated time of a step.
type Truth = fn(&Point) -> f64;

/// The remaining seconds of a run after each of its steps, and the predicted ones, starting before
/// the first step.
fn simulated(plan: &Plan, truth: Truth) -> Vec<[f64; 2]> {
    let jobs = timing::jobs(plan);
    let cells: Vec<&Cell> = plan
        .groups()
        .iter()
        .flat_map(|group| group.cells())
        .collect();
    let mut forecast = Forecast::new(plan, &cells, &jobs, []);
    let (mut steps, mut random) = (Steps::new(plan, &jobs, []), Rng::with_seed(7));
    let cells = cells
        .iter()
        .map(|cell| (cell.id, steps.cell(cell) * truth(&cell.point)))
        .collect::<Vec<_>>();
    let timed = jobs
        .iter()
        .map(|job| (job.id, steps.timing(job) * truth(&job.cell.point)));
    let (mut clock, mut found) = (0.0, vec![[0.0, forecast.ahead(0.0).seconds]]);
    for (id, seconds) in cells.into_iter().chain(timed) {
        // Within a fifth of the usual time.
        clock += seconds * (0.8 + 0.4 * random.f64());
        forecast.finish(id);
        found.push([clock, forecast.ahead(clock).seconds]);
    }
    // The work after the last step is right by construction.
    let total = clock + found[found.len() - 1][1];
    found
        .iter()
        .map(|[clock, said]| [total - clock, *said])
        .collect()
}

/// The largest factor between remaining and predicted time, from a tenth of the time on and before
/// its last hundredth.
fn worst(found: &[[f64; 2]]) -> f64 {
    let total = found[0][0];
    let judged = found
        .iter()
        .filter(|[left, _]| *left <= 0.9 * total && *left >= 0.01 * total);
    judged
        .map(|[left, said]| (said / left).max(left / said))
        .fold(1.0, f64::max)
}

#[test]
fn a_prediction_is_right_within_a_factor_of_one_and_a_half_after_a_tenth_of_the_work() {
    let truths: [(&str, Truth); 4] = [
        ("as stated", |_| 1.0),
        ("five times slower", |_| 5.0),
        ("a hundred times faster", |_| 0.01),
        ("one method is dear", |point| {
            if point.method().name == "split-sum" {
                3.0
            } else {
                1.0
            }
        }),
    ];
    for text in [SWEEP.to_owned(), format!("{SWEEP}{TIMED}")] {
        let plan = plan(&text);
        for (name, truth) in truths {
            let factor = worst(&simulated(&plan, truth));
            assert!(factor <= 1.5, "{name}: {factor}");
        }
    }
}

#[test]
fn shared_work_counts_once_and_kept_references_not_at_all() {
    let plan = plan(EXPERIMENT);
    let cells: Vec<&Cell> = plan.cells.iter().collect();
    let seconds = |kept: Vec<Id>| Forecast::new(&plan, &cells, &[], kept).ahead(0.0).seconds;
    let apart = |cell: &&Cell| Forecast::new(&plan, &[*cell], &[], []).ahead(0.0).seconds;
    let kept = || {
        plan.cells
            .iter()
            .filter_map(|cell| cell.reference)
            .collect()
    };
    assert!(seconds(kept()) < seconds(Vec::new()));
    assert!(seconds(Vec::new()) < cells.iter().map(apart).sum());
    // Frames of a still view share the frame without noise.
    let frames = |motion: &str| {
        let axes = format!(
            "method = [\"sampled\"]\nsamples = [1]\nframes = [4]\nmotion = [\"{motion}\"]\n"
        );
        let plan = self::plan(&format!(
            "name = \"frames\"\nreference = {{ samples = 32, noise_share = 0 }}\n[axes]\n{axes}"
        ));
        Steps::new(&plan, &[], plan.cells[0].reference).cell(&plan.cells[0])
    };
    assert!(
        frames("still") < 0.5 * frames("light"),
        "{} {}",
        frames("still"),
        frames("light")
    );
}

#[test]
fn a_run_predicts_its_time() {
    let bench = Bench::new(&format!("{EXPERIMENT}[timing]\nwarmup = 1\nrounds = 3\n"));
    let stop = AtomicBool::new(false);
    let options = options(bench.dir.path(), &stop);
    let mut shares = Vec::new();
    let mut progress = Each(|_: &str, ahead| shares.push(ahead));
    run(
        &bench.plan,
        &mut fakes(&log()) as &mut MakeRenderer,
        &options,
        &mut progress,
    )
    .unwrap();
    assert_eq!(shares.len(), 1 + 32 + 12);
    assert!(shares[0].share == 0.0 && shares[0].seconds > 0.0);
    // Tables and pages remain.
    let last = shares[shares.len() - 1];
    assert!(
        (0.5..1.0).contains(&last.share) && last.seconds > 0.0,
        "{last:?}"
    );
}
