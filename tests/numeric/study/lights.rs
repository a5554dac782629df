//! Errors by view, tone curve and light, for runs with known numbers.

use super::paper::{F64, Made, Paper, bins, column, finding, finished_of, numbers, only};
use splitsum::draw::figure::Shape;
use splitsum::run::tables::HEADLINE;
use splitsum::study::finished::MetricValues;

#[test]
fn a_bin_has_the_median_over_its_environments() {
    // Three models with the errors 1, 2 and 6 times the bins' own; of the counts, 90 is nearer to
    // 40 than 16 by ratio.
    let mut paper = Paper::new(&["alpha", "brdf", "method", "samples"]);
    for (alpha, scale) in [("0.1", 1.0), ("0.5", 10.0)] {
        for (brdf, own) in [("ggx", 1.0), ("beckmann", 6.0), ("phong", 2.0)] {
            for (method, samples, factor) in [
                ("split-sum", "", 1.0),
                ("sampled", "16", 7.0),
                ("sampled", "90", 3.0),
            ] {
                let errors = [0.1, 0.2, 0.3].map(|error| error * scale * own * factor);
                paper.add(&[alpha, brdf, method, samples], 1.0).bins =
                    bins(HEADLINE, &errors).into();
            }
        }
    }
    let finding = paper.finding("n-dot-v");
    let split = only(&finding.table, &[("method", "split-sum")]);
    let found = numbers(&split, "error");
    let expected = [0.2, 0.4, 0.6, 2.0, 4.0, 6.0];
    assert!(
        found.len() == 6 && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < F64),
        "{found:?}"
    );
    assert!(
        numbers(&split, "n").iter().all(|n| *n == 1.0)
            && numbers(&split, "error_lo").iter().all(|lo| lo.is_nan())
    );
    let panel = &finding.figure.as_ref().unwrap().panels[0];
    let dots = panel.marks.iter().filter_map(|mark| {
        if let Shape::Dot(at) = mark.shape {
            Some(at[1])
        } else {
            None
        }
    });
    assert_eq!(
        (panel.title.as_str(), dots.collect::<Vec<_>>()),
        ("Split sum (textbook)", found)
    );
    let counts = column(&only(&finding.table, &[("method", "sampled")]), "samples");
    assert!(
        counts.len() == 6 && counts.iter().all(|n| n == "90"),
        "{counts:?}"
    );
}

#[test]
fn visible_differences_are_listed_by_exposure_and_contrast() {
    let mut paper = Paper::new(&["alpha", "method", "samples", "exposure", "contrast"]);
    for contrast in ["1", "5"] {
        for (exposure, flip) in [("0.1", 0.04), ("1", 0.2), ("500", 0.01)] {
            for (alpha, own) in [("0.1", 1.0), ("0.5", 1.0), ("1", 2.0)] {
                let flip = own * if contrast == "5" { flip * 10.0 } else { flip };
                let cell = paper.add(&[alpha, "sampled", "16", exposure, contrast], 0.1);
                cell.scores = Some(MetricValues::from_fn(|name| {
                    Some(if name == "flip" { flip } else { 0.1 })
                }));
            }
        }
    }
    let finding = paper.finding("visibility");
    let digest = finding.digest.as_ref().unwrap();
    let shown = |name| column(digest, name).concat();
    assert_eq!(
        ["most at exposure", "contrast", "mean FLIP there"].map(shown),
        ["1", "5", "2"]
    );
    assert_eq!(
        shown("visible at contrast 1"),
        "exposure 1",
        "the median of the three is 0.04 at 0.1"
    );
    assert_eq!(shown("visible at contrast 5"), "every tried exposure");
    let marks = &finding.figure.as_ref().unwrap().panels[0].marks;
    let dots = marks.iter().filter_map(|mark| {
        if let Shape::Dot(at) = mark.shape {
            Some(at)
        } else {
            None
        }
    });
    let expected = [
        [0.1, 0.04],
        [1.0, 0.2],
        [500.0, 0.01],
        [0.1, 0.4],
        [1.0, 2.0],
        [500.0, 0.1],
    ];
    assert_eq!(
        dots.collect::<Vec<_>>(),
        expected,
        "FLIP over exposure, a line per contrast"
    );
    let dark = only(&finding.table, &[("exposure", "0.1"), ("contrast", "1")]);
    assert_eq!(
        (numbers(&dark, "visible"), numbers(&dark, "n")),
        (vec![0.0], vec![1.0]),
        "one environment, 0.04 in its middle"
    );
    assert_eq!(
        [
            numbers(&dark, "flip"),
            numbers(&dark, "flip_least"),
            numbers(&dark, "flip_most")
        ]
        .concat(),
        [0.04, 0.04, 0.08]
    );
}

/// Six maps with a bias of 0.076, which the error nears at 64 samples; the formula, which counts
/// beside fewer maps alone, has one of 10.
#[test]
fn the_first_stop_is_one_of_the_lights_that_count() {
    let mut paper = Paper::new(&["environment", "method", "samples"]);
    for light in [
        "a.hdr",
        "b.hdr",
        "c.hdr",
        "d.hdr",
        "e.hdr",
        "f.hdr",
        "builtin:sky",
    ] {
        let bias = if light.starts_with("builtin") {
            10.0
        } else {
            0.076
        };
        for n in ["1", "2", "4", "8", "16", "32", "64", "128", "256"] {
            paper.add(
                &[light, "sampled", n],
                1.0 / n.parse::<f64>().unwrap() + bias,
            );
        }
    }
    let said = paper.finding("convergence").sentences.markdown();
    assert!(said.contains("first at 64 samples"), "{said}");
}

/// Beside six maps the formula counts in no row, not even in one without a map.
#[test]
fn formulas_count_in_no_part_of_enough_maps() {
    let mut paper = Paper::new(&["environment", "alpha", "method"]);
    for light in [
        "a.hdr",
        "b.hdr",
        "c.hdr",
        "d.hdr",
        "e.hdr",
        "f.hdr",
        "builtin:sky",
    ] {
        let error = if light == "builtin:sky" { 1.0 } else { 0.04 };
        paper.add(&[light, "0.1", "split-sum"], error);
        if light != "a.hdr" {
            paper.add(&[light, "0.5", "split-sum"], error);
        }
    }
    let digest = paper.finding("error").digest.unwrap();
    assert_eq!(column(&digest, "6 environments"), ["0.040 (20 % rms)"; 3]);
}

/// An error that a stronger light shows again is hidden from the intensity after it on, and the
/// least tried light need not be none.
#[test]
fn a_key_light_hides_from_where_every_stronger_one_does() {
    let text = "name = \"made\"\nsize = [16, 16]\nreference = { samples = 32, noise_share = 0 \
                }\n[[lights]]\nkind = \"directional\"\ndirection = [0, -1, -1]\n[axes]\nenvironment \
                = [\"builtin:sky\"]\ndiffuse = [\"none\"]\nalpha = [0.1, 0.5, 1]\nmethod = \
                [\"split-sum\"]\nlight_intensity = [1, 4, 16]\n";
    let run = finished_of(text, |point| {
        let alpha = point.get("alpha").number();
        let flips = if alpha < 0.2 {
            [0.01, 0.2, 0.02]
        } else if alpha < 0.7 {
            [0.01, 0.02, 0.03]
        } else {
            [0.4, 0.3, 0.2]
        };
        let intensity = point.get("light_intensity").number();
        let flip = flips[(intensity.log2() / 2.0) as usize];
        Some(Made {
            flip,
            ..Made::error(0.1)
        })
    });
    let found = finding(&run, "key-light");
    let hidden = |alpha| column(&only(&found.table, &[("alpha", alpha)]), "hidden_from");
    assert_eq!(hidden("0.1"), ["16"; 3]);
    assert_eq!(hidden("0.5"), ["1"; 3]);
    assert_eq!(hidden("1"), [""; 3]);
    let text = found.sentences.markdown();
    for part in [
        "In 1 of 3 settings no tried key light, up to 16 times the light, hides",
        "In 1 it is invisible at 1 times the light and at all above.",
    ] {
        assert!(text.contains(part), "{text}: no {part}");
    }
}
