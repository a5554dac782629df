//! Break-even of synthetic runs with known answers.

use super::asked::{CURVES, digest, samples};
use super::paper::{Made, Paper, column, finding, finished, numbers, only};
use splitsum::draw::figure::{Mark, Panel, Shape};
use splitsum::study::finished::{Finished, MetricValues};
use splitsum::study::frame::Frame;
use splitsum::study::questions::{Finding, question};
use splitsum::study::table::Table;

/// The rows of the metric of radiance; pictures also have rows of FLIP.
fn of_relmse(table: Table) -> Table {
    only(&table, &[("metric", "relmse")])
}

#[test]
fn the_break_even_is_the_first_count_from_which_all_are_better() {
    // By alpha the error of the split sum: always above, between, never; the dip at 4 does not
    // last; equal is not better.
    let cases = [(0.1, 1.0), (0.2, 0.5), (0.3, 0.05), (0.4, 0.1)];
    let curve = [
        (1.0, 0.9),
        (4.0, 0.3),
        (16.0, 0.6),
        (64.0, 0.2),
        (256.0, 0.1),
    ];
    let run = finished(
        &format!("{CURVES}alpha = [0.1, 0.2, 0.3, 0.4]\n"),
        |point| {
            let fixed = cases
                .iter()
                .find(|(alpha, _)| *alpha == point.get("alpha").number())
                .unwrap()
                .1;
            let sampled = |n: f64| curve.iter().find(|(count, _)| *count == n).unwrap().1;
            Some(Made::error(samples(point).map_or(fixed, sampled)))
        },
    );
    let found = finding(&run, "break-even");
    let table = of_relmse(found.table.clone());
    let counts = numbers(&table, "break_even");
    assert_eq!(counts[..2], [1.0, 64.0]);
    assert!(counts[2].is_nan() && counts[3].is_nan(), "{counts:?}");
    assert_eq!(numbers(&table, "largest_tried"), [256.0; 4]);
    // Each alpha has its own answer; nothing is pooled over them.
    assert_eq!(
        digest(&found)[0][3..],
        ["1", "64", "more than 256", "more than 256"]
    );
}

/// Errors 4/n under environments whose split sum has an error that breaks even at these counts.
pub fn under(fixed: &[f64]) -> Finished {
    let names: Vec<String> = (0..fixed.len())
        .map(|i| format!("\"builtin:sky:elevation_deg={}\"", 10 + i))
        .collect();
    finished(
        &format!("environment = [{}]\n{CURVES}", names.join(", ")),
        |point| {
            let place = names
                .iter()
                .position(|name| name.trim_matches('"') == point.get("environment").text())
                .unwrap();
            Some(Made::error(
                samples(point).map_or(fixed[place], |n| 4.0 / n),
            ))
        },
    )
}

#[test]
fn a_figure_of_many_environments_shows_their_middle_first() {
    let errors: [f64; 8] = [0.3, 2.0, 0.3, 0.3, 2.0, 0.3, 0.3, 2.0];
    let run = under(&errors);
    let dots = |panel: &Panel| -> Vec<[f64; 2]> {
        let at = |mark: &Mark| {
            if let Shape::Dot(at) = mark.shape {
                Some(at)
            } else {
                None
            }
        };
        panel.marks.iter().filter_map(at).collect()
    };
    let whiskers = |panel: &Panel| -> Vec<[[f64; 2]; 2]> {
        let ends = |mark: &Mark| {
            if let Shape::Whisker(a, b) = mark.shape {
                Some([a, b])
            } else {
                None
            }
        };
        panel.marks.iter().filter_map(ends).collect()
    };
    // The counts at which 4/n falls below each error: 16 five times, 4 three times.
    assert_eq!(
        digest(&finding(&run, "break-even"))[0][3],
        "16 (95 % 4 to 16)"
    );
    // The split sum's geometric mean is the last of the first panel's dots; Student's interval of
    // the logarithms is around it.
    let figure = finding(&run, "error").figure.unwrap();
    assert_eq!(figure.panels.len(), 1 + errors.len());
    let mean = errors.iter().map(|error| error.ln()).sum::<f64>() / 8.0;
    let variance = errors
        .iter()
        .map(|error| (error.ln() - mean).powi(2))
        .sum::<f64>()
        / 7.0;
    let half = 2.365 * (variance / 8.0).sqrt();
    let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-9;
    let ([.., dot], [.., [from, to]]) = (
        &dots(&figure.panels[0])[..],
        &whiskers(&figure.panels[0])[..],
    ) else {
        panic!()
    };
    assert!(near(dot[1], mean.exp()), "{dot:?}");
    assert!(
        near(from[1], (mean - half).exp()) && near(to[1], (mean + half).exp()),
        "{from:?} {to:?}"
    );
    // The sampled error is 4/n in all of them; the figure has it once per count.
    let figure = finding(&run, "convergence").figure.unwrap();
    assert_eq!(figure.panels.len(), 1);
    assert!(
        dots(&figure.panels[0])
            .iter()
            .all(|[n, error]| near(*error, 4.0 / n))
    );
}

/// The answer is the median crossing of environments, not the median of their counts.
#[test]
fn the_median_is_of_crossings() {
    // 4/n meets 0.9 at 4.4 and 0.22 at 18: the middle is 9.0. Of the counts 16 and 64 it would be
    // 32, rounded to 64.
    let found = finding(&under(&[0.9, 0.22]), "break-even");
    assert_eq!(
        numbers(&of_relmse(found.table.clone()), "break_even"),
        [16.0]
    );
    // Two environments have a range instead of an interval.
    assert!(numbers(&found.table, "break_even_lo")[0].is_nan());
    assert_eq!(digest(&found)[0][3], "16 (environments 16 to 64)");
    // If sampling never wins, there is no count, and the sentence says so.
    let never = finding(&under(&[0.01; 6]), "break-even");
    assert!(
        ["break_even", "break_even_lo", "break_even_hi"]
            .iter()
            .all(|name| numbers(&never.table, name)[0].is_nan())
    );
    let said =
        "`sampled` needs **more than 256 samples per pixel** to beat `split-sum` in `relmse`";
    assert!(
        never.sentences.markdown().starts_with(said),
        "{}",
        never.sentences.markdown()
    );
}

/// A sampling method and the split sum, whose error is 1, under two environments with errors of
/// some counts.
fn two_lights(curves: [&[(&str, f64)]; 2]) -> Paper {
    let mut paper = Paper::new(&["environment", "method", "samples"]);
    for (light, curve) in ["builtin:sky", "builtin:studio"].into_iter().zip(curves) {
        paper.add(&[light, "split-sum", ""], 1.0);
        for (samples, error) in curve {
            paper.add(&[light, "sampled", samples], *error);
        }
    }
    paper
}

/// A count tried in some curves only is unknown for the others.
#[test]
fn curves_of_unequal_counts_answer_where_all_were_tried() {
    let long = [("1", 4.0), ("4", 3.0), ("16", 2.0), ("64", 0.5)];
    let found = two_lights([&long, &long[..3]]).finding("break-even");
    assert_eq!(
        (
            numbers(&found.table, "largest_tried"),
            digest(&found)[0][3].as_str()
        ),
        (vec![16.0], "more than 16")
    );
    let early = [("1", 0.9), ("4", 0.5), ("16", 0.1)];
    let found = two_lights([&early, &early[1..]]).finding("break-even");
    assert_eq!(
        (
            numbers(&found.table, "break_even"),
            digest(&found)[0][3].as_str()
        ),
        (vec![4.0], "at most 4")
    );
    // No count was tried in both.
    let apart = two_lights([&early[..2], &[("16", 0.5), ("64", 0.1)]]);
    assert!((question("break-even").unwrap().answer)(&Frame::new(&apart.run, None)).is_none());
}

/// A method without samples whose error is within the reference's noise is not compared.
#[test]
fn the_noise_of_the_reference_does_not_remove_cases() {
    let mut paper = Paper::new(&["alpha", "method", "samples"]);
    for (alpha, floor) in [("0.1", 0.5), ("0.5", 1e-9)] {
        paper.add(&[alpha, "split-sum", ""], 0.5).noise_floors =
            MetricValues::from_fn(|_| Some(floor));
        for (samples, error) in [("1", 1.0), ("4", 0.6), ("16", 0.1)] {
            paper.add(&[alpha, "sampled", samples], error);
        }
    }
    let found = paper.finding("break-even");
    let answers = (
        column(&found.table, "alpha"),
        numbers(&found.table, "break_even"),
    );
    assert_eq!(
        answers,
        (vec!["0.1".to_owned(), "0.5".to_owned()], vec![16.0, 16.0])
    );
}

/// Every pair of methods has its own break-even, by the metric of radiance on the design and by
/// FLIP in the picture.
#[test]
fn each_pair_of_methods_has_its_own_break_even() {
    let lights = [1.0, 2.0, 4.0, 1.0, 1.0, 1.0];
    let names: Vec<String> = (0..6)
        .map(|i| format!("\"builtin:sky:elevation_deg={}\"", 10 + i))
        .collect();
    let text = format!(
        "environment = [{}]\nscene = [\"design\", \"sphere\"]\nmethod = \
         [\"split-sum\", \"split-sum-two\", \"sampled\", \
         \"sampled-vndf\"]\nsamples = [1, 4, 16, 64]\n",
        names.join(", ")
    );
    let run = finished(&text, |point| {
        let place = names
            .iter()
            .position(|name| name.trim_matches('"') == point.get("environment").text())
            .unwrap();
        let ease = if point.get("method").text() == "sampled-vndf" {
            2.0
        } else {
            1.0
        };
        let fixed = if point.get("method").text() == "split-sum" {
            1.5
        } else {
            0.3
        };
        // 4/n meets 1.5 at 2.7 and 0.3 at 13; half as many visible normals do. FLIP is 8 times as
        // strict.
        let error = samples(point).map_or(fixed / lights[place], |n| 4.0 / (n * ease));
        let flip = samples(point).map_or(fixed, |n| 32.0 / (n * ease));
        Some(Made {
            flip,
            ..Made::error(error)
        })
    });
    let found = finding(&run, "break-even");
    let of = |metric: &str, fixed: &str, sampled: &str| {
        let row = only(
            &found.table,
            &[("metric", metric), ("fixed", fixed), ("sampled", sampled)],
        );
        ["break_even", "break_even_lo", "break_even_hi"].map(|name| numbers(&row, name)[0])
    };
    // Four of six environments agree; the two largest crossings are twice and four times the
    // others.
    assert_eq!(of("relmse", "split-sum", "sampled"), [4.0, 4.0, 16.0]);
    assert_eq!(of("relmse", "split-sum-two", "sampled"), [16.0, 16.0, 64.0]);
    assert_eq!(
        of("relmse", "split-sum-two", "sampled-vndf"),
        [16.0, 16.0, 64.0]
    );
    assert_eq!(of("flip", "split-sum", "sampled-vndf"), [16.0, 16.0, 16.0]);
    assert!(
        of("flip", "split-sum-two", "sampled")[0].is_nan(),
        "107 samples were not tried"
    );
    let said = "`sampled` needs **4 samples per pixel** (95 % 4 to 16) to beat `split-sum` in \
                `relmse` and 64 in `flip`. \
                To beat `split-sum-two`, which errs least, it needs **16** (95 % 16 to 64) in \
                `relmse` and more than 64 in `flip`.";
    assert!(
        found.sentences.markdown().starts_with(said),
        "{}",
        found.sentences.markdown()
    );
    // The figure has FLIP divided by the split sum's, which has one lookup; the other reads two.
    let figure = found.figure.unwrap();
    let [panel] = &figure.panels[..] else {
        panic!()
    };
    let dots = |name: &str| -> Vec<[f64; 2]> {
        let place = figure.series.iter().position(|series| series.name == name);
        let own = panel.marks.iter().filter(|mark| mark.series == place);
        own.filter_map(|mark| {
            if let Shape::Dot(at) = mark.shape {
                Some(at)
            } else {
                None
            }
        })
        .collect()
    };
    let is_near = |name: &str, expected: &[[f64; 2]]| {
        let found = dots(name);
        let near =
            |(a, b): (&[f64; 2], &[f64; 2])| a[0] == b[0] && (a[1] / b[1] - 1.0).abs() < 1e-9;
        assert!(
            found.len() == expected.len() && found.iter().zip(expected).all(near),
            "{name}: {found:?}"
        );
    };
    is_near("Split sum (textbook)", &[[1.0, 1.0]]);
    is_near("Split sum (two lookups)", &[[2.0, 0.3 / 1.5]]);
    is_near(
        "Sampling",
        &[1.0, 4.0, 16.0, 64.0].map(|n| [n, 32.0 / n / 1.5]),
    );
}

/// A setting of the samples alone has an answer for each value; the method without samples has none
/// of its own.
#[test]
fn points_of_pixels_have_their_own_answers() {
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
        column(&row, "samples per pixel").concat()
    });
    assert_eq!(counts, ["4", "16"]);
}

/// One sample a frame errs by 0.8/frames; under a turning light lag remains. The image of one frame
/// belongs to both motions.
#[test]
fn frames_win_from_a_count_on_and_name_their_lag_and_flicker() {
    let mut paper = Paper::new(&["alpha", "method", "samples", "frames", "motion"]);
    paper.add(&["0.5", "split-sum", "", "1", ""], 0.1);
    paper.add(&["0.5", "sampled", "1", "1", ""], 0.8);
    for (frames, motion, error) in [
        ("4", "still", 0.2),
        ("16", "still", 0.05),
        ("4", "light", 0.3),
        ("16", "light", 0.25),
    ] {
        let lag = if motion == "light" { 0.2 } else { 0.0 };
        paper
            .add(&["0.5", "sampled", "1", frames, motion], error)
            .steadiness = Some([lag, 0.5 * error]);
    }
    let Finding { table, figure, .. } = paper.finding("frames");
    let row = |motion| only(&table, &[("motion", motion)]);
    let last = |motion| {
        ["break_even", "ratio", "lag_bias", "flicker"].map(|name| numbers(&row(motion), name)[0])
    };
    let (still, light, near) = (last("still"), last("light"), |a: f64, b: f64| {
        (a - b).abs() < 1e-12
    });
    assert!(
        still
            .iter()
            .zip([16.0, 0.5, 0.0, 0.025])
            .all(|(found, right)| near(*found, right)),
        "{still:?}"
    );
    assert!(
        light[0].is_nan()
            && light[1..]
                .iter()
                .zip([2.5, 0.2, 0.125])
                .all(|(a, b)| near(*a, b)),
        "{light:?}"
    );
    let of = |panel: &Panel| {
        panel
            .marks
            .iter()
            .filter(|mark| matches!(mark.shape, Shape::HorizontalRule(_)))
            .count()
    };
    assert!(figure.unwrap().panels.iter().all(|panel| of(panel) == 1));
}
