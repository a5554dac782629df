//! Break-even of made-up runs whose answers are known: of one pair of methods, and of each.

use super::asked::{CURVES, digest, samples};
use super::paper::{Made, Paper, column, finding, finished, numbers, only};
use crate::run::fake::{ERROR_AT_ONE, SPLIT_SUM_ERROR};
use crate::run::runs;
use splitsum::figure::{Mark, Panel, Shape};
use splitsum::study::finished::Finished;

#[test]
fn a_run_has_the_break_even_of_its_error_model() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), runs::plan(crate::run::whole::EXPERIMENT));
    runs::finished(&plan, dir.path());
    let run = Finished::read(dir.path()).unwrap();
    let found = finding(&run, "break-even");
    // 0.4 / sqrt(4) = 0.2 is above the fixed 0.15, 0.4 / sqrt(16) = 0.1 below it: the tried counts are 1, 4 and 16.
    assert_eq!(numbers(&found.table, "break_even"), [16.0; 4]);
    assert!(numbers(&found.table, "is_resolved").iter().all(|is| *is == 1.0));
    // Squared errors 0.16 / n meet 0.0225.
    let crossing = f64::from(ERROR_AT_ONE / SPLIT_SUM_ERROR).powi(2);
    assert!(numbers(&found.table, "crossing").iter().all(|n| (n / crossing - 1.0).abs() < 1e-3));
    // And its squared error falls with the count.
    let found = finding(&run, "convergence");
    assert!(numbers(&found.table, "slope").iter().all(|slope| slope.is_nan() || (slope + 1.0).abs() < 1e-3));
    assert!(numbers(&found.table, "stops_at").iter().all(|n| n.is_nan()));
}

#[test]
fn the_break_even_is_the_first_count_from_which_all_are_better() {
    // By alpha the error of the split sum: always above, between, never; the dip at 4 does not last; equal is not better.
    let cases = [(0.1, 1.0), (0.2, 0.5), (0.3, 0.05), (0.4, 0.1)];
    let curve = [(1.0, 0.9), (4.0, 0.3), (16.0, 0.6), (64.0, 0.2), (256.0, 0.1)];
    let run = finished(&format!("{CURVES}alpha = [0.1, 0.2, 0.3, 0.4]\n"), |point| {
        let fixed = cases.iter().find(|(alpha, _)| *alpha == point.get("alpha").number()).unwrap().1;
        let sampled = |n: f64| curve.iter().find(|(count, _)| *count == n).unwrap().1;
        Some(Made::error(samples(point).map_or(fixed, sampled)))
    });
    let found = finding(&run, "break-even");
    let counts = numbers(&found.table, "break_even");
    assert_eq!(counts[..2], [1.0, 64.0]);
    assert!(counts[2].is_nan() && counts[3].is_nan(), "{counts:?}");
    assert_eq!(numbers(&found.table, "largest_tried"), [256.0; 4]);
    let crossings = numbers(&found.table, "crossing");
    assert!(crossings[0].is_nan(), "below the smallest count nothing is known");
    // ln 0.6 to ln 0.2 over a factor of four, at ln 0.5.
    let expected = 16.0 * 4f64.powf((0.6f64 / 0.5).ln() / (0.6f64 / 0.2).ln());
    assert!((crossings[1] - expected).abs() < 1e-9, "{crossings:?}");
    // Each alpha has its own answer, and none is pooled over them.
    let counts: Vec<String> = digest(&found).iter().map(|row| row[2].clone()).collect();
    assert_eq!(counts, ["1", "64", "more than 256", "more than 256"]);
}

#[test]
fn each_set_of_tables_has_a_break_even_of_its_own() {
    // Errors 4/n; the split sum errs by 0.3 with one layout and by 2 with the other.
    let run = finished(&format!("{CURVES}layout = [\"cube\", \"octahedral\"]\n"), |point| {
        let fixed = if point.get("layout").text() == "octahedral" { 2.0 } else { 0.3 };
        Some(Made::error(samples(point).map_or(fixed, |n| 4.0 / n)))
    });
    let found = finding(&run, "break-even");
    // The size of the map goes with the layout.
    let rows = digest(&found);
    let ends: Vec<[&str; 2]> = rows.iter().map(|row| [&*row[0], &*row[row.len() - 1]]).collect();
    assert_eq!(ends, [["cube", "16"], ["octahedral", "4"]]);
}

/// Errors 4/n under environments whose split sum has an error that breaks even at these counts.
pub fn under(fixed: &[f64]) -> Finished {
    let names: Vec<String> = (0..fixed.len()).map(|i| format!("\"builtin:sky:elevation_deg={}\"", 10 + i)).collect();
    finished(&format!("environment = [{}]\n{CURVES}", names.join(", ")), |point| {
        let place = names.iter().position(|name| name.trim_matches('"') == point.get("environment").text()).unwrap();
        Some(Made::error(samples(point).map_or(fixed[place], |n| 4.0 / n)))
    })
}

#[test]
fn a_figure_of_many_environments_shows_their_middle_first() {
    let errors: [f64; 8] = [0.3, 2.0, 0.3, 0.3, 2.0, 0.3, 0.3, 2.0];
    let run = under(&errors);
    let dots = |panel: &Panel| -> Vec<[f64; 2]> {
        let at = |mark: &Mark| if let Shape::Dot(at) = mark.shape { Some(at) } else { None };
        panel.marks.iter().filter_map(at).collect()
    };
    let whiskers = |panel: &Panel| -> Vec<[[f64; 2]; 2]> {
        let ends = |mark: &Mark| if let Shape::Whisker(a, b) = mark.shape { Some([a, b]) } else { None };
        panel.marks.iter().filter_map(ends).collect()
    };
    // The counts at which 4/n falls below each error: 16 five times, 4 three times.
    let figure = finding(&run, "break-even").figure.unwrap();
    assert_eq!(
        (dots(&figure.panels[0]), whiskers(&figure.panels[0])),
        (vec![[16.0, 0.0]], vec![[[4.0, 0.0], [16.0, 0.0]]])
    );
    // The split sum's geometric mean is the last of the first panel's dots; Student's interval of the logarithms is around it.
    let figure = finding(&run, "error").figure.unwrap();
    assert_eq!(figure.panels.len(), 1 + errors.len());
    let mean = errors.iter().map(|error| error.ln()).sum::<f64>() / 8.0;
    let variance = errors.iter().map(|error| (error.ln() - mean).powi(2)).sum::<f64>() / 7.0;
    let half = 2.365 * (variance / 8.0).sqrt();
    let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-9;
    let ([.., dot], [.., [from, to]]) = (&dots(&figure.panels[0])[..], &whiskers(&figure.panels[0])[..]) else {
        panic!()
    };
    assert!(near(dot[1], mean.exp()), "{dot:?}");
    assert!(near(from[1], (mean - half).exp()) && near(to[1], (mean + half).exp()), "{from:?} {to:?}");
    // In all of them the sampled error is 4/n; by count it stands once.
    let figure = finding(&run, "convergence").figure.unwrap();
    assert_eq!(figure.panels.len(), 1);
    assert!(dots(&figure.panels[0]).iter().all(|[n, error]| near(*error, 4.0 / n)));
}

/// A design under two lights: sampling with 1, 4 and 16 samples errs by 1, 0.5 and 0.2 at every view, methods without samples by the two
/// errors at grazing and at steep ones.
fn design_of_two_bands(fixed: &[(&str, [f64; 2])]) -> Paper {
    let mut paper = Paper::new(&["scene", "environment", "method", "samples"]);
    let sampled = [("1", 1.0), ("4", 0.5), ("16", 0.2)].map(|(samples, error)| ("sampled", samples, [error; 2]));
    let fixed = fixed.iter().map(|(method, errors)| (*method, "", *errors));
    for light in ["builtin:sky", "builtin:studio"] {
        for (method, samples, error) in sampled.into_iter().chain(fixed.clone()) {
            let bin = |lo: f64, error: f64| super::paper::bin([lo, lo + 0.2], |_| Some(error));
            paper.add(&["design", light, method, samples], 0.5 * (error[0] + error[1])).bins =
                vec![bin(0.0, error[0]), bin(0.8, error[1])].into();
        }
    }
    paper
}

/// The runs of one band of n·v have that band's errors: at grazing views 1 sample is enough, at steep ones 16 are not.
#[test]
fn methods_of_a_design_break_even_by_the_angle_of_view() {
    let paper = design_of_two_bands(&[("split-sum", [2.0, 0.1]), ("split-sum-relative", [0.3, 0.6])]);
    let of_first = design_of_two_bands(&[("split-sum", [2.0, 0.1])]).finding("break-even").table;
    let of_first = only(&of_first, &[("environment", "builtin:sky")]);
    let of_pairs = paper.finding("break-even-of-pairs").table;
    for (from, to, fixed, count) in [
        ("0", "0.2", "split-sum", "1"),
        ("0", "0.2", "split-sum-relative", "16"),
        ("0.8", "1", "split-sum", ""),
        ("0.8", "1", "split-sum-relative", "4"),
    ] {
        let band = [("n_dot_v_from", from), ("n_dot_v_to", to)];
        let row = only(&of_pairs, &[&band[..], &[("fixed", fixed)]].concat());
        assert_eq!(column(&row, "break_even"), [count], "{fixed} from {from}");
        if fixed == "split-sum" {
            assert_eq!(column(&only(&of_first, &band), "break_even"), [count], "from {from}");
        }
    }
    assert_eq!(column(&only(&of_first, &[("n_dot_v_from", "0"), ("n_dot_v_to", "1")]), "break_even"), ["1"]);
}

/// Every pair of methods has its own break-even, by the metric of radiance on the design and by FLIP in the picture.
#[test]
fn each_pair_of_methods_breaks_even_by_itself() {
    let lights = [1.0, 2.0, 4.0, 1.0, 1.0, 1.0];
    let names: Vec<String> = (0..6).map(|i| format!("\"builtin:sky:elevation_deg={}\"", 10 + i)).collect();
    let text = format!(
        "environment = [{}]\nscene = [\"design\", \"sphere\"]\nmethod = [\"split-sum\", \"split-sum-relative\", \"sampled\", \
         \"sampled-vndf\"]\nsamples = [1, 4, 16, 64]\n",
        names.join(", ")
    );
    let run = finished(&text, |point| {
        let place = names.iter().position(|name| name.trim_matches('"') == point.get("environment").text()).unwrap();
        let ease = if point.get("method").text() == "sampled-vndf" { 2.0 } else { 1.0 };
        let fixed = if point.get("method").text() == "split-sum" { 1.5 } else { 0.3 };
        // 4/n meets 1.5 at 2.7 and 0.3 at 13; half as many visible normals do. FLIP is 8 times as strict.
        let error = samples(point).map_or(fixed / lights[place], |n| 4.0 / (n * ease));
        let flip = samples(point).map_or(fixed, |n| 32.0 / (n * ease));
        Some(Made { flip, ..Made::error(error) })
    });
    let found = finding(&run, "break-even-of-pairs");
    let of = |metric: &str, fixed: &str, sampled: &str| {
        let row = only(&found.table, &[("metric", metric), ("fixed", fixed), ("sampled", sampled)]);
        ["break_even", "break_even_lo", "break_even_hi"].map(|name| numbers(&row, name)[0])
    };
    // Medians of the crossings, where four of six environments agree; the interval reaches to those that do not.
    let near = |found: [f64; 3], count: f64, crossing: f64, reach: [f64; 2]| {
        assert_eq!(found[0], count, "{found:?}");
        let [lo, hi] = [found[1], found[2]].map(|end| end / crossing);
        assert!((lo - 1.0).abs() < 1e-9 && hi > reach[0] - 1e-9 && hi < reach[1] + 1e-9, "{found:?}");
    };
    // The two largest of six crossings are twice and four times the others; by FLIP all are alike.
    near(of("relmse", "split-sum", "sampled"), 4.0, 4.0 / 1.5, [2.0, 4.0]);
    near(of("relmse", "split-sum-relative", "sampled"), 16.0, 4.0 / 0.3, [2.0, 4.0]);
    near(of("relmse", "split-sum-relative", "sampled-vndf"), 16.0, 2.0 / 0.3, [2.0, 4.0]);
    near(of("flip", "split-sum", "sampled-vndf"), 16.0, 16.0 / 1.5, [1.0, 1.0]);
    assert!(of("flip", "split-sum-relative", "sampled")[0].is_nan(), "107 samples were not tried");
}

/// A setting of the samples alone has an answer for each value; the method without samples has none of its own.
#[test]
fn points_of_pixels_have_answers_of_their_own() {
    let mut paper = Paper::new(&["environment", "method", "samples", "pixel_points"]);
    for light in ["builtin:sky", "builtin:studio"] {
        paper.add(&[light, "split-sum", "", ""], 1.0);
        for (samples, shared, owen) in [("1", 2.0, 4.0), ("4", 0.5, 2.0), ("16", 0.25, 0.5)] {
            paper.add(&[light, "sampled", samples, "shared"], shared);
            paper.add(&[light, "sampled", samples, "owen"], owen);
        }
    }
    let digest = paper.finding("break-even").digest.unwrap();
    let counts = ["shared", "owen"].map(|points| {
        let row = only(&digest, &[("pixel_points", points)]);
        column(&row, "sky").concat()
    });
    assert_eq!(counts, ["4", "16"]);
}
