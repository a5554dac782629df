//! References that are as exact as their images need, with a synthetic renderer.

use super::fake::Log;
use super::runs::{Silent, assert_alike, fakes, invoke, log, options, plan, summary};
use super::whole::EXPERIMENT;
use splitsum::base::csv::Table;
use splitsum::experiment::{Cell, Plan};
use splitsum::instrument::metrics::{METRICS, NOISE_SHARE};
use splitsum::instrument::pipeline::RenderRequest;
use splitsum::run::estimate::{Ahead, Forecast};
use splitsum::run::store::Store;
use splitsum::run::{MakeRenderer, Progress, RunError, RunOptions, merge, run};
use splitsum::study::finished::Finished;
use std::cell::RefCell;
use std::path::Path;
use std::rc::Rc;
use std::sync::atomic::AtomicBool;

/// The experiment whose references have at most this many samples.
fn adaptive(samples: u32) -> String {
    EXPERIMENT.replace(
        "samples = 64, noise_share = 0",
        &format!("samples = {samples}"),
    )
}

/// Noise of 0.088 at 64 samples and 0.022 at 1024. The tenth of the mean square errors of `sampled`
/// is 0.016, 0.004 and 0.001 at 1, 4 and 16 samples, which a noise of 0.126, 0.063 and 0.032 has: so
/// these need 64, 256 and 1024, since 0.0625 at 128 and 0.031 at 512 leave nothing for the weights of
/// `relmse`. `split-sum` has an error of 0.12 and needs 512.
fn noisy() -> Rc<RefCell<Log>> {
    let log = log();
    log.borrow_mut().noise = Some(|samples| (0.5 / samples as f32).sqrt());
    log.borrow_mut().split_sum_error = Some(|_| 0.12);
    log
}

/// Sample counts of the rendered references.
fn reference_counts(log: &Rc<RefCell<Log>>) -> Vec<u32> {
    let renders = &log.borrow().renders;
    let references = renders.iter().filter(|(method, _)| method == "reference");
    references.map(|(_, samples)| *samples).collect()
}

fn column(dir: &Path, name: &str) -> Vec<String> {
    let table = Table::read(&dir.join("errors.csv")).unwrap();
    let column = table.column(name).unwrap();
    table.rows.iter().map(|row| row[column].clone()).collect()
}

/// Runs a plan in a new folder.
fn whole(plan: &Plan) -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    invoke(plan, dir.path(), &noisy(), usize::MAX).unwrap();
    dir
}

#[test]
fn a_reference_has_the_first_count_that_is_exact_enough_for_each_of_its_images() {
    // Four references, by model and alpha.
    for (most, methods, samples, rounds) in [
        (4096, "[\"sampled\"]", "[1]", &[64][..]),
        (4096, "[\"sampled\"]", "[1, 4]", &[64, 128, 256]),
        (4096, "[\"sampled\"]", "[4, 1]", &[64, 128, 256]),
        (
            4096,
            "[\"sampled\", \"split-sum\"]",
            "[1, 4, 16]",
            &[64, 128, 256, 512, 1024],
        ),
        // The stated count is the most.
        (256, "[\"sampled\"]", "[16]", &[64, 256]),
        (64, "[\"sampled\"]", "[16]", &[64]),
        // Beside an error of 0.4 / 256 even a variance that falls with the square of the count
        // would be too large at 256.
        (1024, "[\"sampled\"]", "[65536]", &[64, 1024]),
    ] {
        let text = adaptive(most)
            .replace("[\"sampled\", \"split-sum\"]", methods)
            .replace("[1, 4, 16]", samples);
        let (dir, log, plan) = (tempfile::tempdir().unwrap(), noisy(), plan(&text));
        invoke(&plan, dir.path(), &log, usize::MAX).unwrap();
        let words = format!("{samples} with at most {most}");
        assert_eq!(reference_counts(&log), rounds.repeat(4), "{words}");
        let last = rounds[rounds.len() - 1];
        assert!(
            column(dir.path(), "reference_samples")
                .iter()
                .all(|count| *count == last.to_string()),
            "{words}"
        );
        let stop = if last < most {
            "noise-share"
        } else {
            "samples"
        };
        assert!(
            column(dir.path(), "reference_stopped_by")
                .iter()
                .all(|by| by == stop),
            "{words}"
        );
    }
}

/// The floor of the same errors is the same share of scores of fewer pixels, but the noise averages
/// out over fewer, and moves them further.
#[test]
fn a_score_of_few_pixels_needs_a_more_exact_reference() {
    let first_round_suffices = |side: u32| {
        let text = adaptive(4096)
            .replace("[\"sampled\", \"split-sum\"]", "[\"sampled\"]")
            .replace("[1, 4, 16]", "[1]")
            .replace("size = [24, 24]", &format!("size = [{side}, {side}]"));
        let (dir, log) = (tempfile::tempdir().unwrap(), noisy());
        invoke(&plan(&text), dir.path(), &log, usize::MAX).unwrap();
        reference_counts(&log).iter().all(|count| *count == 64)
    };
    assert_eq!([24, 8].map(first_round_suffices), [true, false]);
}

/// Score, floor and images equal a run whose references have this count.
#[test]
fn a_reference_that_stops_is_one_of_that_many_samples() {
    let stated = adaptive(1024).replace("samples = 1024", "samples = 1024, noise_share = 0");
    let [adaptive, exact] = [adaptive(4096), stated].map(|text| whole(&plan(&text)));
    for name in [
        "relmse",
        "relmse_noise_floor",
        "tone_mapped_mse",
        "flip",
        "reference_samples",
    ] {
        assert_eq!(
            column(adaptive.path(), name),
            column(exact.path(), name),
            "{name}"
        );
    }
    // Answers take the floor off, which exact references leave.
    let [adaptive, exact] = [adaptive, exact].map(|dir| Finished::read(dir.path()).unwrap());
    let metric = METRICS[1];
    for (net, plain) in adaptive.cells.iter().zip(&exact.cells) {
        let floor = net.noise_floors.get(metric.name).unwrap();
        let [net, plain] = [adaptive.score(net, metric), exact.score(plain, metric)];
        let due = plain.unwrap() - floor;
        assert!(
            (net.unwrap() - due).abs() < 1e-12 && floor > 1e-4,
            "{net:?}, {due}"
        );
    }
}

#[test]
fn the_summary_says_where_references_stopped() {
    let dir = whole(&plan(&adaptive(4096)));
    let words = "4096 samples per pixel at most; 4 of 4 stopped earlier with a noise of at most 0.1 \
                 of each mean square error, which answers take off (";
    assert!(
        summary(dir.path()).contains(words),
        "{}",
        summary(dir.path())
    );
    assert_eq!(NOISE_SHARE, 0.1);
}

#[test]
fn a_stopped_run_ends_like_a_whole_one() {
    let plan = plan(&adaptive(4096));
    let undisturbed = whole(&plan);
    for steps in [1, 7, 20] {
        let dir = tempfile::tempdir().unwrap();
        let mut invocations = 1;
        while invoke(&plan, dir.path(), &noisy(), steps)
            .unwrap()
            .is_stopped
        {
            invocations += 1;
        }
        assert_eq!(invocations, 32usize.div_ceil(steps));
        assert_alike(dir.path(), undisturbed.path(), &plan);
    }
    // The device is lost at some render.
    for renders in [0, 3, 5, 6, 7, 8, 13] {
        let (dir, lost) = (tempfile::tempdir().unwrap(), noisy());
        lost.borrow_mut().renders_left = Some(renders);
        let ended = invoke(&plan, dir.path(), &lost, usize::MAX);
        assert!(matches!(ended, Err(RunError::DeviceLost(_))), "{renders}");
        invoke(&plan, dir.path(), &noisy(), usize::MAX).unwrap();
        assert_alike(dir.path(), undisturbed.path(), &plan);
    }
}

#[test]
fn shards_take_the_counts_of_a_whole_run() {
    let plan = plan(&adaptive(4096));
    let undisturbed = whole(&plan);
    for count in [2, 3] {
        let (dir, stop) = (tempfile::tempdir().unwrap(), AtomicBool::new(false));
        for index in 1..=count {
            let options = RunOptions {
                shard: Some(format!("{index}/{count}").parse().unwrap()),
                ..options(dir.path(), &stop)
            };
            let log = noisy();
            run(
                &plan,
                &mut fakes(&log) as &mut MakeRenderer,
                &options,
                &mut Silent,
            )
            .unwrap();
        }
        merge(&plan, &options(dir.path(), &stop)).unwrap();
        assert_alike(dir.path(), undisturbed.path(), &plan);
    }
}

/// Counts the finished steps that are opened again.
#[derive(Default)]
struct Reopened(usize);

impl Progress for Reopened {
    fn start(&mut self, _: usize, _: usize, _: Ahead) {}
    fn step(&mut self, _: &str, _: Option<&str>, _: Ahead) {}
    fn note(&mut self, _: &str) {}
    fn open_again(&mut self, count: usize) {
        self.0 += count;
    }
}

/// New images may need a more exact reference: then the finished cells of the reference are judged
/// again.
#[test]
fn a_larger_plan_ends_like_a_fresh_run_of_it() {
    let all = plan(&adaptive(4096));
    let undisturbed = whole(&all);
    for (few, reopened, new_images) in [
        // Two exposures of each of four images at one sample.
        ("samples = [1]\nmethod = [\"sampled\"]", 8, 4 * 4),
        ("samples = [1, 4]\nmethod = [\"sampled\"]", 16, 4 * 4),
        // The counts stay.
        ("samples = [16]\nmethod = [\"sampled\"]", 0, 4 * 3),
        (
            "samples = [1, 4]\nmethod = [\"sampled\", \"split-sum\"]",
            0,
            4,
        ),
    ] {
        let part = adaptive(4096)
            .replace("samples = [1, 4, 16]\n", "")
            .replace("method = [\"sampled\", \"split-sum\"]", few);
        let dir = whole(&plan(&part));
        let (stop, log, mut progress) = (AtomicBool::new(false), noisy(), Reopened::default());
        let options = options(dir.path(), &stop);
        run(
            &all,
            &mut fakes(&log) as &mut MakeRenderer,
            &options,
            &mut progress,
        )
        .unwrap();
        assert_eq!(progress.0, reopened, "{few}");
        let is_image = |(method, _): &&(String, u32)| method != "reference";
        let images = log.borrow().renders.iter().filter(is_image).count();
        assert_eq!(images, new_images, "{few}");
        super::runs::written(dir.path()).write().unwrap();
        assert_alike(dir.path(), undisturbed.path(), &all);
    }
}

/// Without the record all images of the reference are judged again.
#[test]
fn a_lost_record_of_a_reference_is_made_again() {
    let plan = plan(&adaptive(4096));
    let undisturbed = whole(&plan);
    let dir = whole(&plan);
    let first = &plan.cells[0];
    let id = first.reference.unwrap();
    let store = Store::read_only(dir.path());
    std::fs::remove_file(dir.path().join(format!("references/{id}.json"))).unwrap();
    std::fs::remove_file(store.cell_path(first.id)).unwrap();
    invoke(&plan, dir.path(), &noisy(), usize::MAX).unwrap();
    assert_alike(dir.path(), undisturbed.path(), &plan);
}

/// An image that cannot be rendered judges nothing until it can.
#[test]
fn an_image_that_failed_judges_later() {
    let plan = plan(&adaptive(4096).replace("[1, 4, 16]", "[1]"));
    let undisturbed = whole(&plan);
    let (dir, broken) = (tempfile::tempdir().unwrap(), noisy());
    broken.borrow_mut().broken_method = Some("split-sum");
    let outcome = invoke(&plan, dir.path(), &broken, usize::MAX).unwrap();
    assert_eq!(outcome.failures.len(), 8);
    assert_eq!(reference_counts(&broken), [64; 4]);
    invoke(&plan, dir.path(), &noisy(), usize::MAX).unwrap();
    assert_alike(dir.path(), undisturbed.path(), &plan);

    let (dir, stop) = (tempfile::tempdir().unwrap(), AtomicBool::new(false));
    let options = RunOptions {
        fail_fast: true,
        ..options(dir.path(), &stop)
    };
    let outcome = run(
        &plan,
        &mut fakes(&broken) as &mut MakeRenderer,
        &options,
        &mut Silent,
    );
    assert_eq!(outcome.unwrap().failures.len(), 1);
}

/// The last frame of a sequence may be right by luck of its noise: its references are exact.
#[test]
fn references_of_sequences_have_all_samples() {
    let text = adaptive(4096)
        .replace("exposure = [1, 10]", "frames = [1, 4]")
        .replace("[1, 4, 16]", "[1]");
    let dir = whole(&plan(&text));
    assert!(
        column(dir.path(), "reference_samples")
            .iter()
            .all(|count| count == "4096")
    );
}

#[test]
fn references_state_one_rule() {
    let fault = |reference: &str, set: &[&str]| {
        let text = EXPERIMENT.replace("samples = 64, noise_share = 0", reference);
        let set: Vec<String> = set.iter().map(|text| text.to_string()).collect();
        let read = Plan::from_text(Path::new("tiny.toml"), &text, &set);
        read.map(|plan| plan.config.reference.noise_share())
            .map_err(|error| error.to_string())
    };
    assert_eq!(fault("samples = 64", &[]), Ok(Some(0.1)));
    assert_eq!(
        fault("samples = 64, noise_share = 0.01", &[]),
        Ok(Some(0.01))
    );
    assert_eq!(fault("samples = 64, noise_share = 0", &[]), Ok(None));
    assert_eq!(fault("samples = 64", &["noise_share=0"]), Ok(None));
    assert_eq!(
        fault("samples = 64, noise_share = 0", &["noise_share=0.5"]),
        Ok(Some(0.5))
    );
    assert_eq!(fault("samples = 64, relative_error = 0.01", &[]), Ok(None));
    // Noise would distort some metrics.
    for (line, share) in [
        ("ssim", None),
        ("bias_rel", None),
        ("rmse", Some(0.1)),
        ("flip", Some(0.1)),
    ] {
        let reference = format!("samples = 64 }}\nmetric = \"{line}\"\nprecompute = {{");
        assert_eq!(fault(&reference, &[]), Ok(share));
    }
    let both = fault(
        "samples = 64, relative_error = 0.01, noise_share = 0.1",
        &[],
    );
    let both = both.unwrap_err();
    assert!(
        both.contains("tiny.toml:5:") && both.contains("relative_error stops"),
        "{both}"
    );
    for (reference, set, words) in [
        (
            "samples = 64, relative_error = 0.01",
            &["noise_share=0.1"][..],
            "--set noise_share",
        ),
        (
            "samples = 64, noise_share = 1.5",
            &[],
            "1.5 is outside [0, 1]",
        ),
        ("samples = 64", &["noise_share=-1"], "-1 is outside [0, 1]"),
        (
            "samples = 64",
            &["noise_share=0", "noise_share=0.1"],
            "is set twice",
        ),
    ] {
        let fault = fault(reference, set).unwrap_err();
        assert!(fault.contains(words), "{fault}");
    }
}

/// An experiment with the count of a round makes the same request, and a forecast does not ask for
/// references of all samples.
#[test]
fn rounds_are_requests_of_fewer_samples() {
    let adaptive = plan(&adaptive(4096));
    let stated = plan(&EXPERIMENT.replace("samples = 64", "samples = 1024"));
    let counts = |request: RenderRequest| {
        (
            request.reference_samples,
            request.shading.samples,
            request.seed,
        )
    };
    let point = adaptive.reference_point(&adaptive.cells[0].point);
    assert_eq!(
        adaptive.reference_counts(&point),
        [64, 128, 256, 512, 1024, 2048, 4096]
    );
    let stated_point = stated.reference_point(&stated.cells[0].point);
    assert_eq!(
        counts(adaptive.reference_round(&point, 1024)),
        counts(stated.reference_request(&stated_point))
    );
    assert_eq!(counts(adaptive.least_reference(&point)).0, 64);
    assert_eq!(counts(stated.least_reference(&stated_point)).0, 1024);

    let seconds = |text: &str| {
        let plan = plan(&text.replace("[24, 24]", "[512, 512]"));
        let cells: Vec<&Cell> = plan.cells.iter().collect();
        Forecast::new(&plan, &cells, &[], []).ahead(0.0).seconds
    };
    let exact = EXPERIMENT.replace("samples = 64", "samples = 4096");
    assert!(seconds(&self::adaptive(4096)) < 0.5 * seconds(&exact));
}
