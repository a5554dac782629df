//! Answers of made-up runs whose slopes, break-even points, times and effects are known.

use splitsum::environment::Environment;
use splitsum::pixels::RgbImage;
use splitsum::runner::environments::Luminance;
use splitsum::runner::statistics::Random;
use splitsum::study::answers::Answered;
use splitsum::study::answers::break_even::{Basis, BreakEven, Level, crossing_interval, interval_text};
use splitsum::study::answers::cases::Winner;
use splitsum::study::answers::run_folder::RunFolder;
use splitsum::study::answers::study::Study;
use splitsum::study::answers::times::{TimeLevel, time_match};
use splitsum::study::answers::{Answers, dynamic_range, exposure};
use splitsum::table::csv::Table;
use std::f64::consts::TAU;
use std::fmt::Write;
use std::path::Path;

/// f64 arithmetic of a few logarithms.
const F64: f64 = 1e-9;

/// One row of a made-up run: values of the axes that the header names, error, display error.
pub struct Made {
    axes: &'static [&'static str],
    rows: Vec<(Vec<String>, String, f64)>,
}

impl Made {
    pub fn new(axes: &'static [&'static str]) -> Self {
        Self { axes, rows: Vec::new() }
    }

    pub fn add(&mut self, axes: &[&str], error: f64) {
        self.add_text(axes, &format!("{error:e}"), 0.1);
    }

    pub fn add_text(&mut self, axes: &[&str], error: &str, flip: f64) {
        assert_eq!(axes.len(), self.axes.len());
        self.rows.push((axes.iter().map(|text| text.to_string()).collect(), error.to_owned(), flip));
    }

    /// Writes the folder of a run. Three bins of `n_dot_v` share the error as `bin_factors`, with equal weights.
    pub fn write(&self, dir: &Path, bin_factors: [f64; 3]) {
        let text = |rows: &str, head: &str| format!("cell,{}{head}\n{rows}", self.axes.join(","));
        let (mut errors, mut bins) = (String::new(), String::new());
        for (i, (axes, error, flip)) in self.rows.iter().enumerate() {
            let axes = axes.join(",");
            // The reference's noise is a thousandth: what is below ten times that is not resolved.
            let verdict = if error.parse::<f64>().is_ok_and(|e| e < 1e-2) { "reference-limited" } else { "resolved" };
            writeln!(errors, "{i:04x},{axes},{error},{flip},1e-3,{verdict}").unwrap();
            for (b, factor) in bin_factors.iter().enumerate() {
                let error = error.parse::<f64>().unwrap_or(f64::NAN) * factor;
                writeln!(bins, "{i:04x},{axes},{},{},100,{error:e}", b as f64 * 0.25, (b + 1) as f64 * 0.25).unwrap();
            }
        }
        let put = |name: &str, text: String| std::fs::write(dir.join(name), text).unwrap();
        put("errors.csv", text(&errors, ",relmse,flip,relmse_noise_floor,verdict"));
        put("errors_by_n_dot_v.csv", text(&bins, ",n_dot_v_from,n_dot_v_to,pixel_count,relmse"));
        let provenance = serde_json::json!({
            "schema_version": 1, "name": "made", "question": "What?", "cell_count": self.rows.len(), "sessions": [{ "device":
                { "name": "paper", "driver": "pencil", "type": "cpu" }, "date_utc": "2026-01-01T00:00:00Z" }],
        });
        put("provenance.json", provenance.to_string());
    }

    pub fn answers(&self, dir: &Path, bin_factors: [f64; 3]) -> (Answers, Answered) {
        self.write(dir, bin_factors);
        let runs = [RunFolder::read(dir).unwrap()];
        let study = Study::new(&runs, &["made".to_owned()]).distinct();
        (Answers::new(&study, &runs), Answered::of_run(dir).unwrap_or_else(|error| panic!("{error}")))
    }
}

fn normal(random: &mut Random) -> f64 {
    let mut uniform = || (random.below(1 << 53) as f64 + 0.5) / (1u64 << 53) as f64;
    let radius = (-2.0 * uniform().ln()).sqrt();
    radius * (TAU * uniform()).cos()
}

#[test]
fn an_interval_of_break_even_covers_the_truth_as_often_as_it_says() {
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
    let texts = [[16.0, f64::INFINITY], [0.0, 4.0], [0.0, f64::INFINITY], [0.0, 9.0], [5.0, f64::INFINITY], [5.0, 9.0]];
    assert_eq!(
        texts.map(|ends| interval_text(ends, [4, 16])),
        ["never up to 16", "always, from 4", "undecided", "at most 9.0", "5.0 or more", "5.0 to 9.0"]
    );
}

#[test]
fn the_jackknife_of_bins_is_that_of_a_ratio() {
    // Errors 1, 2, 3 over fixed 1: leaving one out gives the means 2.5, 2, 1.5.
    let found = Level::of_bins(4, &[(1.0, 1.0, 1.0), (1.0, 2.0, 1.0), (1.0, 3.0, 1.0)]).unwrap();
    let logs = [2.5f64, 2.0, 1.5].map(f64::ln);
    let mean = logs.iter().sum::<f64>() / 3.0;
    let variance = 2.0 / 3.0 * logs.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
    assert!((found.ln_ratio - 2f64.ln()).abs() < F64);
    assert!((found.hi - found.lo - 2.0 * 4.303 * variance.sqrt()).abs() < F64, "{found:?}");
    // A weight counts as often as its pixels do, and two bins say nothing of spread.
    let weighted = Level::of_bins(4, &[(3.0, 1.0, 1.0), (1.0, 5.0, 1.0), (4.0, 2.0, 1.0)]).unwrap();
    assert!((weighted.ln_ratio - 2f64.ln()).abs() < F64);
    assert_eq!(Level::of_bins(4, &[(1.0, 1.0, 1.0); 2]), None);
    assert_eq!(Level::of_bins(4, &[(1.0, 0.0, 1.0); 3]), None, "ln 0");
    assert_eq!(Level::of_point_sets(4, &[1.0], 1.0), None, "one set has no spread");
    assert_eq!(Level::of_point_sets(4, &[1.0, f64::NAN], 1.0), None);
}

fn time(samples: u32, ratio: f64) -> TimeLevel {
    let interval = [ratio * 0.9, ratio * 1.1];
    TimeLevel { samples, ratio, interval, rounds: 15, tables_ms: 30.0, fixed_ms: 2.0, is_cpu: true }
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
    let few = TimeLevel { interval: [f64::NAN; 2], rounds: 5, ..time(4, 2.0) };
    let found = time_match(&[time(1, 0.5), few, time(16, 8.0)]).unwrap();
    assert!((found.samples - 2.0).abs() < F64 && found.interval.is_none(), "{found:?}");
}

#[test]
fn known_curves_have_their_slope_and_break_even() {
    let mut made = Made::new(&["alpha", "method", "samples", "point_set", "exposure"]);
    for (alpha, fixed) in [("0.1", 0.3), ("0.5", 1e3), ("1", 0.005)] {
        made.add(&[alpha, "split-sum", "", "", "1"], fixed);
        for n in [1, 4, 16, 64, 256] {
            for (set, luck) in [("0", 1.25), ("1", 0.8), ("2", 1.0)] {
                let error = 4.0 / f64::from(n) * luck;
                made.add(&[alpha, "sampled", &n.to_string(), set, "1"], error);
                made.add(&[alpha, "sampled", &n.to_string(), set, "10"], error);
            }
        }
    }
    let dir = tempfile::tempdir().unwrap();
    let (answers, answered) = made.answers(dir.path(), [0.5, 1.0, 1.5]);
    let [pair] = answers.pairs.as_slice() else { panic!("{:?}", answers.pairs) };
    let [middle, always, never] = pair.cases.as_slice() else { panic!("{:?}", pair.cases) };
    // The geometric mean of the sets is 4 / n, so it meets 0.3 at n = 13.3.
    let crossing = middle.whole.crossing.unwrap();
    assert_eq!((middle.whole.break_even, middle.whole.basis), (BreakEven::From(16), Basis::PointSets));
    assert!((crossing - 4.0 / 0.3).abs() < 1e-6, "{crossing}");
    let [lo, hi] = middle.whole.interval.unwrap();
    // Student's half width of ln: t s / sqrt(3), with s = ln 1.25, on both sides of it at slope -1.
    let factor = (4.303 * 1.25f64.ln() / 3f64.sqrt()).exp();
    assert!((hi / crossing / factor - 1.0).abs() < 1e-6 && (crossing / lo / factor - 1.0).abs() < 1e-6, "{lo} {hi}");
    assert_eq!((always.whole.break_even, always.whole.interval), (BreakEven::From(1), Some([0.0, 1.0])));
    assert_eq!(never.whole.break_even, BreakEven::Above(256));
    assert_eq!(
        never.whole.interval,
        Some([256.0, f64::INFINITY]),
        "at 256 samples the interval of 0.0156 ends at 0.009"
    );
    assert!(pair.cases.iter().all(|case| case.whole.at_equal_time == Winner::NotTimed));
    assert_eq!(middle.bins.len(), 3);
    assert!(middle.bins.iter().all(|bin| bin.crossing.break_even == BreakEven::From(16)));
    for curve in &answers.curves {
        let slope = curve.slope.unwrap();
        assert!((slope.value + 1.0).abs() < F64, "{slope:?}");
        assert!(curve.points.iter().all(|point| point.errors.len() == 3), "exposures share their image");
    }
    assert!(answered.summary.contains("never up to 256") && answered.summary.contains("always, from 1"));
    for name in ["convergence_slopes.csv", "convergence_slopes.svg"] {
        assert!(answered.files.iter().any(|(known, _)| known == name), "{name}");
    }
    let table = Table::read(&{
        answered.write().unwrap();
        dir.path().join("answers/break_even.csv")
    })
    .unwrap();
    let answer = table.column("answer").unwrap();
    assert_eq!(table.rows.iter().map(|row| row[answer].as_str()).collect::<Vec<_>>(), ["from", "always", "never"]);
}

#[test]
fn a_slope_is_fitted_above_the_noise_only() {
    let mut made = Made::new(&["method", "samples"]);
    for n in [1u32, 4, 16, 64, 256, 1024] {
        // 1/n down to the reference's noise, where it stays.
        made.add(&["sampled", &n.to_string()], (1.0 / f64::from(n)).max(5e-3));
    }
    let dir = tempfile::tempdir().unwrap();
    let (answers, _) = made.answers(dir.path(), [1.0; 3]);
    let slope = answers.curves[0].slope.unwrap();
    assert!((slope.value + 1.0).abs() < F64 && slope.n == 4, "{slope:?}");
}

#[test]
fn one_point_set_takes_its_interval_from_the_bins() {
    let mut made = Made::new(&["method", "samples"]);
    made.add(&["split-sum", ""], 0.3);
    [1, 4, 16, 64].iter().for_each(|n| made.add(&["sampled", &n.to_string()], 4.0 / f64::from(*n)));
    let dir = tempfile::tempdir().unwrap();
    let (answers, answered) = made.answers(dir.path(), [0.5, 1.0, 1.5]);
    let whole = &answers.pairs[0].cases[0].whole;
    assert_eq!(whole.basis, Basis::NDotVBins);
    // All bins have the same ratio: the answer hangs on none of them.
    let [lo, hi] = whole.interval.unwrap();
    assert!((hi / lo - 1.0).abs() < 1e-6 && (lo - 4.0 / 0.3).abs() < 1e-6, "{lo} {hi}");
    assert!(answers.pairs[0].cases[0].bins.iter().all(|bin| bin.crossing.interval.is_none()));
    assert!(answered.summary.contains("one point set only"));
}

#[test]
fn runs_that_lack_something_say_less_and_do_not_fail() {
    let answer = |made: &Made| {
        let dir = tempfile::tempdir().unwrap();
        let (answers, answered) = made.answers(dir.path(), [1.0; 3]);
        answered.write().unwrap();
        (answers, answered)
    };
    let mut one_count = Made::new(&["method", "samples"]);
    one_count.add(&["sampled", "16"], 0.1);
    one_count.add(&["split-sum", ""], 0.2);
    let (answers, answered) = answer(&one_count);
    assert!(answers.pairs.is_empty() && answers.curves[0].slope.is_none());
    assert!(answered.summary.contains("## Errors"), "{}", answered.summary);

    let mut alone = Made::new(&["method", "samples"]);
    [1, 4, 16].iter().for_each(|n| alone.add(&["sampled", &n.to_string()], 1.0 / f64::from(*n)));
    let (answers, _) = answer(&alone);
    assert!(answers.pairs.is_empty() && answers.curves[0].slope.is_some());

    let mut broken = Made::new(&["method", "samples"]);
    broken.add(&["split-sum", ""], 0.2);
    broken.add_text(&["sampled", "1"], "NaN", f64::NAN);
    broken.add_text(&["sampled", "4"], "", 0.1);
    broken.add_text(&["sampled", "16"], "0", 0.0);
    broken.add_text(&["sampled", "64"], "inf", 0.0);
    let (answers, answered) = answer(&broken);
    let whole = &answers.pairs[0].cases[0].whole;
    assert_eq!((whole.break_even, whole.interval), (BreakEven::Above(64), None));
    assert!(answers.curves[0].slope.is_none());
    assert!(answered.files.iter().all(|(_, text)| !text.contains("\"NaN\"")));

    let (answers, answered) = answer(&Made::new(&["method", "samples"]));
    assert!(answers.curves.is_empty() && answered.summary.contains("No cell is done yet"));
}

#[test]
fn an_effect_is_the_ratio_of_cells_that_differ_in_nothing_else() {
    let mut made = Made::new(&["alpha", "method", "samples", "lod_bias"]);
    for (alpha, size) in [("0.1", 1.0), ("0.5", 20.0)] {
        for n in ["16", "40"] {
            for (bias, factor) in [("-1", 3.0), ("0", 1.0), ("1", 0.5)] {
                // The bias of 1 is better at the one alpha and worse at the other.
                let factor = if bias == "1" && alpha == "0.5" { 2.0 } else { factor };
                made.add(&[alpha, "sampled", n, bias], size * factor);
            }
            made.add(&[alpha, "sampled-unfiltered", n, ""], size * 10.0);
        }
    }
    let dir = tempfile::tempdir().unwrap();
    let (answers, answered) = made.answers(dir.path(), [1.0; 3]);
    let find = |axis: &str, value: &str, method: &str, alpha: Option<&str>| {
        let fits = |e: &&splitsum::study::answers::effects::Effect| {
            (e.axis.as_str(), e.value.as_str(), e.method.as_str(), e.alpha.as_deref()) == (axis, value, method, alpha)
        };
        answers.effects.iter().find(fits).unwrap_or_else(|| panic!("no {axis} {value} {method} {alpha:?}"))
    };
    // The first value, -1, is the base.
    let zero = find("lod_bias", "0", "sampled 16", None);
    assert!((zero.ratio - 1.0 / 3.0).abs() < F64 && zero.n == 2 && zero.better == 2);
    assert!((zero.interval[1] - zero.interval[0]).abs() < F64, "both alphas agree");
    let one = find("lod_bias", "1", "sampled 40", None);
    assert!((one.ratio - 1.0 / 3.0).abs() < F64 && one.interval[0] < 0.01 && one.interval[1] > 10.0, "{one:?}");
    assert!((find("lod_bias", "1", "sampled 40", Some("0.1")).ratio - 0.5 / 3.0).abs() < F64);
    let mut sets = Made::new(&["alpha", "method", "samples", "lod_bias", "point_set"]);
    for (alpha, factor) in [("0.1", 2.0), ("0.5", 8.0)] {
        for (set, luck) in [("0", 1.5), ("1", 1.0 / 1.5), ("2", 1.0)] {
            sets.add(&[alpha, "sampled", "16", "0", set], 1.0);
            sets.add(&[alpha, "sampled", "16", "1", set], factor * luck);
        }
    }
    let of_sets = tempfile::tempdir().unwrap();
    let (of_sets, _) = sets.answers(of_sets.path(), [1.0; 3]);
    let effect = of_sets.effects.iter().find(|effect| effect.axis == "lod_bias" && effect.alpha.is_none()).unwrap();
    // Two cases, not six pairs: the geometric mean of 2 and 8, with one degree of freedom.
    assert!(effect.n == 2 && (effect.ratio - 4.0).abs() < F64 && effect.interval[1] > 1e3, "{effect:?}");
    // The method without bias stands beside the default bias of the other.
    let unfiltered = find("method", "sampled-unfiltered", "16", None);
    assert!((unfiltered.ratio - 10.0).abs() < F64 && unfiltered.n == 2, "{unfiltered:?}");
    assert!(answered.summary.contains("## What `lod_bias` changes"));
    assert!(answered.files.iter().any(|(name, _)| name == "effect_of_lod_bias.svg"));
}

#[test]
fn what_the_curve_hides_is_told_by_exposure_and_contrast() {
    let mut made = Made::new(&["method", "samples", "exposure", "contrast"]);
    for contrast in ["1", "5"] {
        for (exposure, flip) in [("0.1", 0.04), ("1", 0.2), ("500", 0.01)] {
            let flip = if contrast == "5" { flip * 10.0 } else { flip };
            made.add_text(&["sampled", "16", exposure, contrast], "0.1", flip);
        }
    }
    let dir = tempfile::tempdir().unwrap();
    let (answers, answered) = made.answers(dir.path(), [1.0; 3]);
    let [plain, strong] = exposure::hiding(&answers.visibility).try_into().unwrap();
    assert_eq!((plain.peak, plain.hidden_at), ((1.0, 0.2), vec![0.1, 500.0]));
    assert_eq!((strong.contrast, strong.hidden_at), (5.0, vec![]));
    let sentence = &answered.record.answer.sentence;
    for part in [
        "shows most at exposure 1 and contrast 5 (mean FLIP 2.0)",
        "visible at every tried exposure (contrast 5), at exposure 1 (contrast 1), and the other 2 of 6 tone curves",
        "visible is a mean FLIP of at least 0.05, this project's convention",
    ] {
        assert!(sentence.contains(part), "{part}: {sentence}");
    }
    assert!(answered.files.iter().any(|(name, _)| name == "exposure_and_contrast.svg"));
}

#[test]
fn the_error_grows_by_a_factor_a_stop() {
    let mut made = Made::new(&["environment", "environment_clip_log2", "method", "samples"]);
    let mut lights = "environment,environment_clip_log2,mean_luminance,peak_luminance,dynamic_range_stops\n".to_owned();
    for clip in 0..5 {
        writeln!(lights, "builtin:sky,{clip},1,{},{clip}", 2f64.powi(clip)).unwrap();
        made.add(&["builtin:sky", &clip.to_string(), "sampled", "16"], 0.01 * 1.5f64.powi(clip));
        made.add(&["builtin:sky", &clip.to_string(), "split-sum", ""], 0.1);
    }
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("environments.csv"), lights).unwrap();
    let (answers, answered) = made.answers(dir.path(), [1.0; 3]);
    let growth = dynamic_range::growth(&answers.dynamic_range);
    let of = |method: &str| growth.iter().find(|one| one.method == method).unwrap().fit.value.exp();
    assert!((of("sampled 16") - 1.5).abs() < F64 && (of("split-sum") - 1.0).abs() < F64);
    // What has no samples leads.
    let answer = &answered.record.answer;
    assert_eq!(answer.number, "×1.0");
    assert!(answer.sentence.contains("split-sum in sky is level, 0.10 at 0 stops to 0.10 at 4"), "{answer:?}");
    let fact =
        "The error of sampled 16 in sky grows from 0.010 at 0 stops to 0.051 at 4.0 stops, the most, ×1.5, between";
    assert!(answer.facts.iter().any(|said| said.starts_with(fact)), "{answer:?}");
}

#[test]
fn the_range_of_an_environment_is_peak_over_mean() {
    let flat = Luminance::of(&Environment::from_image("flat", RgbImage::filled(8, 4, [0.5; 3])));
    assert!((flat.mean - 0.5).abs() < 1e-6 && flat.range_stops().unwrap().abs() < 1e-6, "{flat:?}");
    // The upper half of the sphere at 2, the lower at 0: mean 1, whatever the number of rows.
    let half = RgbImage::from_fn(8, 6, |_, y| if y < 3 { [2.0; 3] } else { [0.0; 3] });
    let half = Luminance::of(&Environment::from_image("half", half));
    assert!((half.mean - 1.0).abs() < 1e-6 && (half.range_stops().unwrap() - 1.0).abs() < 1e-6, "{half:?}");
    let black = Luminance::of(&Environment::from_image("black", RgbImage::filled(2, 2, [0.0; 3])));
    assert_eq!(black.range_stops(), None);
}
