//! Times and what they pay for, of runs whose times are known.

use super::estimate::normal;
use super::paper::{F64, Paper, column, numbers, only};
use crate::run::timing_ratios::{record, swept};
use splitsum::run::statistics::Random;
use splitsum::run::timing::TimingRecord;
use splitsum::study::frame::Frame;
use splitsum::study::frame::band::{Level, between, crossing_interval};
use splitsum::study::frame::times::{TimeLevel, time_match};
use splitsum::study::questions::question;

#[test]
fn an_interval_of_a_crossing_covers_the_truth_as_often_as_it_says() {
    const TRIALS: usize = 2000;
    const COUNTS: [u32; 6] = [1, 4, 16, 64, 256, 1024];
    let mut random = Random::new(7);
    // The error 1/n of the typical set meets 1/16 at a tried count; 1/30 between two, where interpolation averages two counts.
    for (truth, least, most) in [(16.0, 0.935, 0.975), (30.0, 0.935, 1.0)] {
        let (mut covered, mut widths) = (0, Vec::new());
        for _ in 0..TRIALS {
            let level = |samples: &u32| {
                let errors: Vec<f64> =
                    (0..8).map(|_| (0.4 * normal(&mut random)).exp() / f64::from(*samples)).collect();
                Level::of_point_sets(*samples, &errors, 1.0 / truth).unwrap()
            };
            let levels: Vec<Level> = COUNTS.iter().map(level).collect();
            let [lo, hi] = crossing_interval(&levels).unwrap();
            covered += usize::from(lo <= truth && truth <= hi);
            widths.push(hi / lo);
        }
        // 95 % within three standard deviations of 2000 trials; more is allowed only between tried counts.
        let coverage = covered as f64 / TRIALS as f64;
        assert!((least..=most).contains(&coverage), "{coverage} of the intervals hold {truth}");
        // Not by being useless: two half widths t s / sqrt(8) = 0.33 of ln(error) are a factor of 2 at slope -1.
        widths.sort_by(f64::total_cmp);
        assert!((1.5..2.4).contains(&widths[TRIALS / 2]), "median width {}", widths[TRIALS / 2]);
    }
}

fn level(samples: u32, ln_ratio: f64, half: f64) -> Level {
    Level { samples, ln_ratio, lo: ln_ratio - half, hi: ln_ratio + half }
}

#[test]
fn an_interval_ends_where_the_band_meets_one_and_is_open_where_it_does_not() {
    // The band falls by 2 from count 4 to 16: its lower end is 0 a quarter of the way, its upper end three quarters.
    let interval = crossing_interval(&[level(4, 1.0, 0.5), level(16, -1.0, 0.5)]).unwrap();
    let at = |t: f64| 4.0 * 4f64.powf(t);
    assert!((interval[0] - at(0.25)).abs() < F64 && (interval[1] - at(0.75)).abs() < F64, "{interval:?}");
    let ends = |levels: &[Level]| crossing_interval(levels).unwrap();
    assert_eq!(ends(&[level(4, 1.0, 0.5), level(16, 0.9, 0.5)]), [16.0, f64::INFINITY], "never");
    assert_eq!(ends(&[level(4, -1.0, 0.5), level(16, -2.0, 0.5)]), [0.0, 4.0], "always");
    assert_eq!(ends(&[level(4, 0.1, 0.5), level(16, -0.1, 0.5)]), [0.0, f64::INFINITY], "undecided");
    // Better, worse, better: the hull of what cannot be told apart.
    let lucky = ends(&[level(1, -0.1, 0.2), level(4, 0.3, 0.2), level(16, -1.0, 0.2)]);
    assert!(lucky[0] == 0.0 && (4.0..16.0).contains(&lucky[1]), "{lucky:?}");
    assert_eq!(crossing_interval(&[]), None);
    assert_eq!(between(&[(4.0, 1.0), (16.0, 4.0)], 2.0), None);
    assert!(between(&[(4.0, 1.0), (16.0, 4.0)], 8.0).is_some_and(|y| (y - 2.0).abs() < F64));
}

#[test]
fn a_level_has_the_interval_of_student() {
    let found = Level::of_point_sets(4, &[1.25, 1.0, 0.8], 0.5).unwrap();
    // Three logarithms s, 0, -s: the standard deviation is s, t of two degrees 4.303.
    let half = 4.303 * 1.25f64.ln() / 3f64.sqrt();
    assert!((found.ln_ratio - 2f64.ln()).abs() < F64 && (found.hi - found.lo - 2.0 * half).abs() < F64, "{found:?}");
    assert_eq!(Level::of_point_sets(4, &[1.0], 1.0), None, "one set has no spread");
    assert_eq!(Level::of_point_sets(4, &[], 1.0), None);
    assert_eq!(Level::of_point_sets(4, &[1.0, f64::NAN], 1.0), None);
}

fn time(samples: u32, ratio: f64) -> TimeLevel {
    TimeLevel { samples, ratio, interval: [ratio * 0.9, ratio * 1.1] }
}

#[test]
fn equal_time_is_where_the_ratio_of_times_is_one() {
    let found = time_match(&[time(1, 0.5), time(4, 2.0), time(16, 8.0)]).unwrap();
    assert!((found.samples - 2.0).abs() < F64, "{found:?}");
    let [lo, hi] = found.interval.unwrap();
    assert!(lo < 2.0 && hi > 2.0 && hi < 4.0, "{found:?}");
    let slower = time_match(&[time(1, 1.5), time(4, 2.0)]).unwrap();
    assert_eq!((slower.samples, slower.interval), (0.0, Some([0.0, 1.0])));
    let faster = time_match(&[time(1, 0.2), time(4, 0.5)]).unwrap();
    assert_eq!((faster.samples, faster.interval), (f64::INFINITY, Some([4.0, f64::INFINITY])));
    assert_eq!(time_match(&[]), None);
    // Too few rounds at one count: the point stands, without an interval.
    let few = TimeLevel { interval: [f64::NAN; 2], ..time(4, 2.0) };
    let found = time_match(&[time(1, 0.5), few, time(16, 8.0)]).unwrap();
    assert!((found.samples - 2.0).abs() < F64 && found.interval.is_none(), "{found:?}");
}

/// Frames of `sampled` that take as long as 1 + its count, beside one of the split sum that takes 9: 8 samples fit.
fn timed(rounds: usize) -> Vec<TimingRecord> {
    let frame = |method: &str, samples: &str, ms: f64| {
        let mut record =
            record("frame", &[("brdf", "ggx"), ("method", method), ("samples", samples)], &[("shade", ms)]);
        record.passes[0].ms.truncate(rounds);
        record
    };
    let counts = [1, 4, 16, 64];
    let sampled = counts.iter().map(|n| frame("sampled", &n.to_string(), 1.0 + f64::from(*n)));
    sampled.chain([frame("split-sum", "", 9.0)]).collect()
}

/// A sampled error of 1 / n beside those of the split sum, by alpha, with and without further point sets.
fn errors(fixed: &[(&str, f64)], sets: &[(&str, f64)]) -> Paper {
    let mut paper = Paper::new(&["brdf", "alpha", "method", "samples", "point_set"]);
    for (alpha, error) in fixed {
        paper.add(&["ggx", alpha, "split-sum", "", ""], *error);
        for n in [1, 4, 16, 64] {
            for (set, luck) in sets {
                paper.add(&["ggx", alpha, "sampled", &n.to_string(), set], luck / f64::from(n));
            }
        }
    }
    paper
}

#[test]
fn in_equal_time_wins_what_needs_fewer_samples_than_fit() {
    // The errors meet at 2 samples, at 32 and at 8; 7 fit by the log-log line between 5/9 at 4 and 17/9 at 16.
    let fits = 4.0 * 4f64.powf((9.0f64 / 5.0).ln() / (17.0f64 / 5.0).ln());
    let mut paper = errors(&[("0.1", 1.0 / 2.0), ("0.5", 1.0 / 32.0), ("1", 1.0 / 8.0)], &[("0", 1.0)]);
    paper.run.timings = timed(7);
    let finding = paper.finding("equal-time");
    assert_eq!(column(&finding.table, "verdict"), ["sampled", "split-sum", "undecided"]);
    let found = numbers(&finding.table, "samples_at_equal_time");
    assert!(found.iter().all(|n| (n - fits).abs() < 1e-6), "{found:?} {fits}");
    // In that time the sampled error is 1 / fits.
    let ratios = numbers(&finding.table, "error_ratio");
    assert!(
        ratios.iter().zip([2.0, 32.0, 8.0]).all(|(ratio, at)| (ratio * fits / at - 1.0).abs() < 1e-6),
        "{ratios:?}"
    );
    let at_equal_error = numbers(&finding.table, "samples_at_equal_error");
    assert!(
        at_equal_error.iter().zip([2.0, 32.0, 8.0]).all(|(n, at)| (n / at - 1.0).abs() < 1e-6),
        "{at_equal_error:?}"
    );
    assert!(question("equal-time").unwrap().rests_on_cpu_times(&Frame::new(&paper.run, None)));
    assert!(!question("break-even").unwrap().rests_on_cpu_times(&Frame::new(&paper.run, None)));
}

#[test]
fn point_sets_widen_what_is_undecided() {
    // The errors meet at 15 samples, and 7.8 fit: sets that scatter by a factor of 1.05 tell, ones that scatter by 3 do not. One set alone
    // would say no more than between 4 and 16.
    let verdict = |spread: f64| {
        let mut paper = errors(&[("0.5", 1.0 / 15.0)], &[("0", spread), ("1", 1.0 / spread), ("2", 1.0)]);
        paper.run.timings = timed(7);
        column(&paper.finding("equal-time").table, "verdict").concat()
    };
    assert_eq!([verdict(1.05), verdict(3.0)], ["split-sum", "undecided"]);
}

/// The split sum takes longer under the larger map, where more samples fit.
#[test]
fn each_map_has_the_times_of_its_own_frames() {
    let fitting = |maps: &[(&str, f64)]| {
        let mut paper = Paper::new(&["environment", "method", "samples"]);
        for (map, slower) in maps {
            let id = paper.add(&[map, "split-sum", ""], 0.1).id.clone();
            for n in [1, 4, 16, 64] {
                paper.add(&[map, "sampled", &n.to_string()], 1.0 / f64::from(n));
            }
            for mut record in timed(7) {
                (record.cell, record.block) = (id.clone(), record.block + map);
                let factor = if record.axes["method"] == "split-sum" { *slower } else { 1.0 };
                record.passes[0].ms.iter_mut().for_each(|ms| *ms *= factor);
                paper.run.timings.push(record);
            }
        }
        numbers(&paper.finding("equal-time").table, "samples_at_equal_time")
    };
    let maps = [("builtin:sky", 1.0), ("builtin:studio", 3.0)];
    let [small, large] = maps.map(|map| fitting(&[map]));
    assert!(large[0] > 2.0 * small[0], "{small:?} {large:?}");
    assert_eq!(fitting(&maps), [small, large].concat());
}

#[test]
fn five_rounds_decide_nothing() {
    let mut paper = errors(&[("0.1", 0.5)], &[("0", 1.0)]);
    paper.run.timings = timed(5);
    let finding = paper.finding("equal-time");
    assert_eq!(column(&finding.table, "verdict"), ["too few rounds for an interval"]);
    assert!(numbers(&finding.table, "samples_at_equal_time_lo")[0].is_nan());
    let frames = paper.finding("frame-time");
    assert!(numbers(&frames.table, "ms_lo").iter().chain(&numbers(&frames.table, "ratio_lo")).all(|lo| lo.is_nan()));
    assert!(column(&frames.table, "verdict").iter().filter(|verdict| !verdict.is_empty()).all(|v| v == "AMBIGUOUS"));
    assert!(!frames.sentence.contains("NaN") && !frames.digest.unwrap().markdown().contains("NaN"));
}

#[test]
fn without_times_no_question_of_times_is_served() {
    let paper = errors(&[("0.1", 0.5)], &[("0", 1.0)]);
    assert!(["equal-time", "frame-time", "table-cost"].iter().all(|name| paper.lacks(name).is_some()));
}

/// A split sum beside a sampled image, with these times.
fn beside(records: Vec<TimingRecord>) -> Paper {
    let mut paper = Paper::new(&["method", "samples"]);
    paper.add(&["split-sum", ""], 0.3);
    paper.add(&["sampled", "40"], 0.2);
    paper.run.timings = records;
    paper
}

#[test]
fn ratios_are_those_of_frames_timed_together() {
    let finding = beside(swept()).finding("frame-time");
    let ratio = |method, samples, over| {
        let own =
            only(&finding.table, &[("method", method), ("samples", samples), ("over", over), ("masking", "separable")]);
        numbers(&own, "ratio")
    };
    assert_eq!(ratio("sampled", "40", "split-sum"), [3.0]);
    assert_eq!(ratio("sampled-unfiltered", "16", "split-sum"), [1.5]);
    assert_eq!(ratio("sampled", "40", "sampled-unfiltered 40"), [1.5], "two of one kind at the same count");
    assert_eq!(ratio("sampled", "40", "sampled-unfiltered 16"), [0.0; 0]);
    let split = only(&finding.table, &[("method", "split-sum")]);
    assert_eq!((numbers(&split, "ms"), column(&split, "over")), (vec![2.0; 2], vec![String::new(); 2]));
    // 2 ms of passes within 1 ms of the host's time cannot be.
    assert!(column(&finding.table, "host_check").iter().all(|check| check == "passes-exceed-wall"));
}

#[test]
fn alternative_tables_are_a_range_and_never_a_sum() {
    let own: Vec<TimingRecord> = swept().into_iter().filter(|record| record.axes["masking"] == "separable").collect();
    let finding = beside(own).finding("table-cost");
    let digest = finding.digest.as_ref().unwrap();
    let split = |pass| column(&only(digest, &[("tables of", "split-sum"), ("pass", pass)]), "ms once").remove(0);
    assert_eq!(["all", "prefilter", "mips", "dfg"].map(split), ["40 to 382", "30 to 372", "2.0", "8.0"]);
    assert!(!digest.markdown().contains("422") && !finding.table.csv().contains("422"));
    // Frames of 6 against 2 ms pay 4 ms each, and the mips are common: 38 and 380 ms.
    let paid = only(&finding.table, &[("pass", "all"), ("over", "sampled 40")]);
    assert_eq!(column(&paid, "prefilter_sample_count"), ["64", "1024"]);
    assert_eq!((numbers(&paid, "ms"), numbers(&paid, "payback_frames")), (vec![38.0, 380.0], vec![10.0, 95.0]));
    // A method without tables is one whose tables cost nothing; its frames take 2 ms more.
    let paid = only(&finding.table, &[("pass", "all"), ("over", "sampled-unfiltered 40")]);
    assert_eq!((numbers(&paid, "ms"), numbers(&paid, "payback_frames")), (vec![40.0, 382.0], vec![20.0, 191.0]));
    assert!(finding.table.columns.iter().all(|name| name != "masking"), "one masking only");
}

#[test]
fn each_set_of_tables_has_a_row_of_its_own() {
    let finding = beside(swept()).finding("table-cost");
    let keys = ["method", "masking", "prefilter_sample_count", "pass", "over"].map(|name| column(&finding.table, name));
    let mut seen: Vec<Vec<&String>> =
        (0..finding.table.rows.len()).map(|i| keys.iter().map(|key| &key[i]).collect()).collect();
    let all = seen.len();
    seen.sort();
    seen.dedup();
    // Per masking: two sets of three passes, mips of the sampled method, and three rivals for each set.
    assert_eq!((seen.len(), all), (2 * (6 + 1 + 6), 2 * (6 + 1 + 6)));
}

#[test]
fn slower_frames_never_pay() {
    let mut records = vec![record("frame", &[("method", "split-sum")], &[("shade", 4.0)])];
    records.push(record("frame", &[("method", "sampled"), ("samples", "1")], &[("shade", 2.0)]));
    records.push(record("precompute", &[("method", "split-sum")], &[("dfg", 8.0)]));
    records.push(record("precompute", &[("method", "sampled")], &[]));
    let finding = beside(records).finding("table-cost");
    let paid = only(&finding.table, &[("over", "sampled 1")]);
    assert_eq!((column(&paid, "payback"), numbers(&paid, "ms")), (vec!["never".to_owned()], vec![8.0]));
    assert!(numbers(&paid, "payback_frames")[0].is_nan());
}
