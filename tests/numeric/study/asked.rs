//! Convergence, error and effects of synthetic runs with known answers.

use super::paper::{F64, Made, column, finding, finished, numbers, only};
use splitsum::experiment::axis::Point;
use splitsum::experiment::value::Value;
use splitsum::study::questions::Finding;

pub fn samples(point: &Point) -> Option<f64> {
    match point.get("samples") {
        Value::Count(n) => Some(f64::from(*n)),
        _ => None,
    }
}

pub fn digest(finding: &Finding) -> Vec<Vec<String>> {
    let digest = finding.digest.as_ref().unwrap();
    digest
        .rows
        .iter()
        .map(|row| row.iter().map(splitsum::study::table::shown).collect())
        .collect()
}

pub const CURVES: &str = "method = [\"sampled\", \"split-sum\"]\nsamples = [1, 4, 16, 64, 256]\n";

#[test]
fn a_slope_is_fitted_above_the_noise_only() {
    let run = finished(
        "method = [\"sampled\"]\nsamples = [1, 4, 16, 64, 256, 1024]\n",
        |point| {
            // 1/n down to the reference's noise, where it stays: 100 floors of a mean square are
            // ten of a difference.
            let n = samples(point).unwrap();
            Some(Made {
                floor: 5e-3 / 50.0,
                ..Made::error((1.0 / n).max(5e-3))
            })
        },
    );
    let found = finding(&run, "convergence");
    let slopes = numbers(&found.table, "slope");
    assert!(
        slopes.iter().all(|slope| (slope + 1.0).abs() < F64),
        "{slopes:?}"
    );
    assert_eq!(
        numbers(&found.table, "is_resolved"),
        [1.0, 1.0, 1.0, 1.0, 0.0, 0.0]
    );
    assert!(
        numbers(&found.table, "stops_at").iter().all(|n| n.is_nan()),
        "the noise of the reference is not a bias"
    );
    assert!(
        numbers(&found.table, "slope_standard_error")
            .iter()
            .all(|error| *error < F64)
    );
}

#[test]
fn an_error_stops_falling_at_its_bias() {
    // Variance 1/n over a squared bias b: a doubling removes (1/n - 1/2n)/(1/n + b). From 32
    // samples on that is 14.5 %, from 64 on 8.5 %.
    let run = finished(
        "method = [\"sampled\"]\nsamples = { pow2 = [0, 9] }\nalpha = [0.1, 0.5]\n",
        |point| {
            let (n, bias) = (
                samples(point).unwrap(),
                if point.get("alpha").number() == 0.1 {
                    0.076
                } else {
                    0.0
                },
            );
            Some(Made::error(1.0 / n + bias))
        },
    );
    let found = finding(&run, "convergence");
    let stops = numbers(&found.table, "stops_at");
    assert!(
        stops[..10].iter().all(|n| *n == 64.0) && stops[10..].iter().all(|n| n.is_nan()),
        "{stops:?}"
    );
}

#[test]
fn an_error_is_a_root_mean_square_beside_its_square() {
    let run = finished(
        "method = [\"sampled\", \"split-sum\"]\nsamples = [4, 64]\nalpha = [0.1, 0.5]\n",
        |point| {
            let at = if point.get("alpha").number() == 0.1 {
                0.01
            } else {
                0.04
            };
            Some(Made::error(samples(point).map_or(at, |n| at / n)))
        },
    );
    let found = finding(&run, "error");
    assert_eq!(
        column(&found.table, "method"),
        [
            "sampled",
            "sampled",
            "sampled",
            "sampled",
            "split-sum",
            "split-sum"
        ]
    );
    let percents = numbers(&found.table, "rms_percent");
    assert!(
        (percents[4] - 10.0).abs() < F64 && (percents[5] - 20.0).abs() < F64,
        "{percents:?}"
    );
    // The method without samples leads; the geometric mean of 0.01 and 0.04 is 0.02.
    let said = &found.sentences.markdown();
    assert!(
        said.contains("`split-sum`") && said.contains(" 0.020"),
        "{said}"
    );
    let rows = digest(&found);
    assert_eq!(rows[0], ["0.1", "0.316", "0.010 (10 % rms)"]);
    // A metric that is not a mean square has no root.
    let frame = splitsum::study::frame::Frame::new(&run, Some("rmse"));
    let question = splitsum::study::questions::question("error").unwrap();
    let of_rmse = (question.answer)(&frame).unwrap();
    assert!(
        !of_rmse.sentences.markdown().contains('%')
            && of_rmse.sentences.markdown().contains("`rmse`"),
        "{}",
        of_rmse.sentences.markdown()
    );
    assert!(
        numbers(&of_rmse.table, "rms_percent")
            .iter()
            .all(|x| x.is_nan())
    );
}

#[test]
fn an_effect_is_the_ratio_to_the_first_value_of_its_axis() {
    // A bias of 1 halves the error, a bias of 2 triples it. At alpha 0.5 neither the base nor the
    // bias of 2 is above the noise.
    let axes = "method = [\"sampled\"]\nsamples = [4]\nlod_bias = [0, 1, 2]\nalpha = [0.1, 0.5]\n";
    let run = finished(axes, |point| {
        let bias = point.get("lod_bias").number();
        let error = [1.0, 0.5, 3.0][bias as usize];
        let is_noise = point.get("alpha").number() == 0.5 && bias != 1.0;
        Some(Made {
            floor: if is_noise { error / 4.0 } else { 1e-12 },
            ..Made::error(error)
        })
    });
    let found = finding(&run, "effect");
    assert_eq!(numbers(&found.table, "ratio"), [0.5, 0.5, 3.0, 3.0]);
    assert_eq!(numbers(&found.table, "is_resolved"), [1.0, 1.0, 1.0, 0.0]);
    let rows = digest(&found);
    assert_eq!(
        rows.iter().map(|row| row[5..].to_vec()).collect::<Vec<_>>(),
        [["0.50", "1 of 1"], ["3.0", "0 of 1"]]
    );
    let sentences = found.sentences.markdown();
    assert!(
        sentences.contains("1 of 4 ratios are within the noise of their references"),
        "{sentences}"
    );
}

#[test]
fn a_digest_has_the_order_of_the_axis_whatever_is_within_the_noise() {
    // At the first alpha, whose rows come first, only the bias of 2 is above the noise.
    let axes = "method = [\"sampled\"]\nsamples = [4]\nalpha = [0.1, 0.5]\nlod_bias = [0, 1, 2]\n";
    let run = finished(axes, |point| {
        let bias = point.get("lod_bias").number();
        let is_noise = point.get("alpha").number() == 0.1 && bias != 2.0;
        Some(Made {
            floor: if is_noise { 1.0 } else { 1e-12 },
            ..Made::error(1.0 + bias)
        })
    });
    let rows = digest(&finding(&run, "effect"));
    let values: Vec<&str> = rows.iter().map(|row| row[1].as_str()).collect();
    assert_eq!(values, ["1", "2"]);
}

#[test]
fn ratios_on_both_sides_of_one_are_listed_along_their_axis() {
    let axes = "environment = [\"builtin:sky\", \"builtin:studio\"]\nmethod = \
                [\"sampled\"]\nlod_bias = [0, 1]\n";
    let ratios = [(0.05, 4.0), (0.1, 2.0), (0.25, 0.5), (0.5, 0.25)];
    let biased = |point: &Point, ratio: f64| {
        Some(Made::error(if point.get("lod_bias").number() == 1.0 {
            ratio
        } else {
            1.0
        }))
    };
    let run = finished(
        &format!("{axes}alpha = [0.05, 0.1, 0.25, 0.5]\n"),
        |point| {
            biased(
                point,
                ratios
                    .iter()
                    .find(|(alpha, _)| *alpha == point.get("alpha").number())
                    .unwrap()
                    .1,
            )
        },
    );
    let found = finding(&run, "effect");
    let part = "at alpha 0.25 (0.50) and 0.5 (0.25), and more at 0.05 (4.0) and 0.1 (2.0).";
    assert!(
        found.sentences.markdown().contains(part),
        "{}",
        found.sentences.markdown()
    );
    // Over all alphas they have no mean.
    assert_eq!(
        column(found.digest.as_ref().unwrap(), "all"),
        ["4.0", "2.0", "0.50", "0.25", ""]
    );

    let by_light = |sky: f64, studio: f64| {
        let of = |point: &Point| {
            if point.get("environment").text() == "builtin:sky" {
                sky
            } else {
                studio
            }
        };
        finding(&finished(axes, |point| biased(point, of(point))), "effect")
    };
    let found = by_light(2.0, 0.25);
    assert!(
        found
            .sentences
            .markdown()
            .contains("studio (0.25), and more at sky (2.0)."),
        "{}",
        found.sentences.markdown()
    );
    // Within 5 % of 1 nothing changes its sign.
    assert!(
        !by_light(1.02, 0.5)
            .sentences
            .markdown()
            .contains("and more")
    );
}

#[test]
fn incomplete_runs_answer_less_and_do_not_fail() {
    // Infinite, zero or failed values make no case; the others still answer.
    let broken = finished(
        "method = [\"sampled\", \"split-sum\"]\nsamples = [1, 4, 16, 64]\n",
        |point| match samples(point) {
            Some(1.0) => Some(Made::error(f64::NAN)),
            Some(4.0) => None,
            Some(16.0) => Some(Made::error(0.0)),
            Some(_) => Some(Made::error(f64::INFINITY)),
            None => Some(Made::error(0.2)),
        },
    );
    let found = only(
        &finding(&broken, "break-even").table,
        &[("metric", "relmse")],
    );
    assert!(
        numbers(&found, "largest_tried") == [64.0] && numbers(&found, "break_even")[0].is_nan()
    );
    let frame = splitsum::study::frame::Frame::new(&broken, None);
    for question in splitsum::study::questions::QUESTIONS
        .iter()
        .filter(|question| question.lack(&frame.shape).is_none())
    {
        let said = (question.answer)(&frame)
            .map(|finding| finding.sentences.markdown())
            .unwrap_or_default();
        assert!(
            !said.contains("NaN") && !said.contains("inf"),
            "{}: {said}",
            question.name
        );
    }
    // Nothing is done yet.
    let none = finished(CURVES, |_| None);
    let frame = splitsum::study::frame::Frame::new(&none, None);
    assert!(
        splitsum::study::questions::QUESTIONS
            .iter()
            .all(|question| (question.answer)(&frame).is_none())
    );
}

#[test]
fn models_that_oppose_each_other_are_not_pooled() {
    // Ten environments, under which the crossing of `sampled` with `split-sum` moves by a factor of
    // four; ggx needs 16 times the samples.
    let names: Vec<String> = (0..10)
        .map(|i| format!("\"builtin:sky:elevation_deg={}\"", 10 + i))
        .collect();
    let axes = format!(
        "environment = [{}]\nbrdf = [\"ggx\", \"phong\"]\nalpha = [0.1, 0.5]\n{CURVES}",
        names.join(", ")
    );
    let run = finished(&axes, |point| {
        let place = names
            .iter()
            .position(|name| name.trim_matches('"') == point.get("environment").text())
            .unwrap();
        let needs = if point.get("brdf").text() == "ggx" {
            48.0
        } else {
            3.0
        } * 4f64.powf(place as f64 / 9.0 - 0.5);
        Some(Made::error(samples(point).map_or(1.0 / needs, |n| 1.0 / n)))
    });
    let found = finding(&run, "break-even");
    // Of ten crossings from 24 to 96 the middle is 48, and an end of the interval lies between 70
    // and 83.
    let (rows, [ggx, phong]) = (digest(&found), ["64 (95 % 64 to 256)", "4 (95 % 4 to 16)"]);
    assert_eq!(rows[0], ["relmse", "ggx", "split-sum", "sampled", ggx, ggx]);
    assert_eq!(
        rows[1],
        ["relmse", "phong", "split-sum", "sampled", phong, phong]
    );
}

#[test]
fn an_irradiance_map_of_another_size_is_compared_with_coefficients() {
    // Neither size is the default, so the first one run replaces it.
    let axes = "environment = [\"builtin:sky\"]\nmethod = [\"none\"]\nirradiance_size = [[18, 18], \
                [5, 5]]\n\
                irradiance_sample_count = [[128, 32], [32, 8]]\nprefilter = [\"sampled\"]\n";
    let text = |point: &Point, name: &str| point.get(name).to_string();
    let run = super::paper::finished_of(
        &format!(
            "name = \"made\"\nsize = [16, 16]\nreference = {{ samples = 32, noise_share = 0 }}\n[axes]\ndiffuse = \
             [\"sh9\", \"irradiance-map\"]\n{axes}"
        ),
        |point| {
            let error = match (
                text(point, "diffuse").as_str(),
                text(point, "irradiance_size").as_str(),
            ) {
                ("sh9", _) => 1.0,
                (_, "18x18") => 0.25,
                _ => 8.0,
            };
            Some(Made::error(error))
        },
    );
    let found = finding(&run, "effect");
    let methods: Vec<f64> = column(&found.table, "axis")
        .iter()
        .zip(numbers(&found.table, "ratio"))
        .filter(|(axis, _)| *axis == "diffuse")
        .map(|(_, ratio)| ratio)
        .collect();
    assert_eq!(methods, [0.25]);
}
