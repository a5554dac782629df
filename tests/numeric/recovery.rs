//! Recovered materials: fits to photos with known answers, and the table of a run.

use crate::run::runs::{Bench, log};
use splitsum::base::math::brent;
use splitsum::base::names::Listed;
use splitsum::instrument::metrics::Epsilon;
use splitsum::instrument::recovery::{F0_MAX, Fit, Lines, Loss, Photo, Problem};

/// Widths of a grid, with a gap of 0.05 as in `experiments/recovery.toml` below 0.7.
fn grid() -> Vec<f64> {
    (0..17).map(|index| 0.2 + 0.05 * f64::from(index)).collect()
}

/// A lobe of this roughness at 400 places, as offset and slope in F0: narrow lobes are higher in
/// the middle and lower at the rim.
fn lines(roughness: f64) -> Lines {
    let place = |index: u32| f64::from(index) / 400.0;
    let lobe = |x: f64| (-x * x / (2.0 * roughness * roughness)).exp() / roughness;
    Lines {
        roughness,
        offset: (0..400)
            .map(|i| 0.02 * (1.0 + place(i)).powi(5) * roughness)
            .collect(),
        slope: (0..400).map(|i| 0.3 + lobe(place(i))).collect(),
    }
}

fn family() -> Vec<Lines> {
    grid().into_iter().map(lines).collect()
}

fn photo(values: Vec<f64>) -> Photo {
    Photo::exposed(values, Epsilon::of_light(0.5))
}

fn solved(family: &[Lines], photo: &Photo, loss: Loss) -> Fit {
    Problem {
        lines: family,
        photo,
        loss,
    }
    .solve()
}

/// The minimum of a function in [-2, 1], and the most values that finding it may take.
struct Valley {
    function: fn(f64) -> f64,
    lowest: f64,
    count_max: u32,
}

/// A parabola, a smooth minimum that is not one, a kink, a cusp and an end of the interval. The
/// golden section takes 33 values.
#[test]
fn brents_method_narrows_to_the_minimum() {
    let valley = |function, lowest, count_max| Valley {
        function,
        lowest,
        count_max,
    };
    let valleys = [
        valley(|x| (x - 0.3).powi(2), 0.3, 8),
        valley(
            |x| ((x + 2.01).ln() - 0.8).powi(2),
            0.8_f64.exp() - 2.01,
            12,
        ),
        valley(|x| (x - 0.3).abs(), 0.3, 33),
        valley(|x| (x - 0.3).abs().sqrt(), 0.3, 33),
        valley(|x| x, -2.0, 33),
    ];
    for (index, valley) in valleys.iter().enumerate() {
        let count = std::cell::Cell::new(0);
        let counted = |x| {
            count.set(count.get() + 1);
            (valley.function)(x)
        };
        let found = brent::minimum(counted, [-2.0, 1.0], 1e-6);
        assert!((found - valley.lowest).abs() < 1e-6, "{index}: {found}");
        assert!(count.get() <= valley.count_max, "{index}: {count:?}");
    }
    // Within an interval that is narrow already nothing is sought.
    assert_eq!(brent::minimum(|x| x, [0.5, 0.5], 1e-6), 0.5);
}

/// Photos by the method itself hide nothing.
#[test]
fn an_image_of_the_method_itself_is_recovered_exactly() {
    let family = family();
    for loss in Loss::all() {
        for (index, f0) in [(3, 0.04), (8, 0.6), (12, 1.0)] {
            let photo = photo(family[index].at(f0).collect());
            let fit = solved(&family, &photo, *loss);
            let name = loss.name();
            // Without a curve F0 has a closed form; with one, a search narrows it.
            let near = if [Loss::Relative, Loss::Mse].contains(loss) {
                0.0
            } else {
                3e-4
            };
            assert!(
                (fit.roughness - family[index].roughness).abs() <= near,
                "{name}: {fit:?}"
            );
            assert!(
                (fit.f0 / f0 - 1.0).abs() <= near.max(1e-12),
                "{name}: {fit:?}"
            );
            assert!(fit.loss < 1e-4, "{name}: {fit:?}");
        }
    }
}

/// Between two widths values are interpolated; the lobe is not a line in its width.
#[test]
fn a_width_between_two_of_the_grid_is_recovered() {
    let family = family();
    for loss in Loss::all() {
        for (roughness, f0) in [(0.33, 0.9), (0.52, 0.5), (0.68, 0.1), (0.87, 1.0)] {
            let fit = solved(&family, &photo(lines(roughness).at(f0).collect()), *loss);
            let name = loss.name();
            assert!(
                (fit.roughness - roughness).abs() < 4e-3,
                "{name} {roughness}: {fit:?}"
            );
            assert!(
                (fit.f0 / f0 - 1.0).abs() < 6e-3,
                "{name} {roughness}: {fit:?}"
            );
        }
    }
}

/// A method that is too dark by a factor recovers the F0 over that factor, at the same width.
#[test]
fn a_factor_of_the_image_is_a_factor_of_f0() {
    let family = family();
    let dark: Vec<Lines> = family
        .iter()
        .map(|lines| Lines {
            roughness: lines.roughness,
            offset: lines.offset.iter().map(|value| 0.8 * value).collect(),
            slope: lines.slope.iter().map(|value| 0.8 * value).collect(),
        })
        .collect();
    // Without an offset the image is proportional to F0.
    let bare = |lines: &[Lines]| -> Vec<Lines> {
        let bare = |lines: &Lines| Lines {
            offset: vec![0.0; 400],
            ..lines.clone()
        };
        lines.iter().map(bare).collect()
    };
    let (family, dark) = (bare(&family), bare(&dark));
    for loss in Loss::all() {
        let fit = solved(&dark, &photo(family[6].at(0.5).collect()), *loss);
        assert!(
            (fit.f0 - 0.5 / 0.8).abs() < 3e-4,
            "{}: {fit:?}",
            loss.name()
        );
        assert!(
            (fit.roughness - 0.5).abs() < 1e-3,
            "{}: {fit:?}",
            loss.name()
        );
    }
}

/// The fit of a photo that no material explains has the least loss of a fine grid of materials.
#[test]
fn a_fit_has_the_least_loss() {
    let family = family();
    let odd: Vec<f64> = lines(0.47)
        .at(0.7)
        .zip(0..)
        .map(|(value, index)| value * (1.0 + 0.3 * (0.05 * f64::from(index)).sin()))
        .collect();
    let photo = photo(odd);
    for loss in Loss::all() {
        let problem = Problem {
            lines: &family,
            photo: &photo,
            loss: *loss,
        };
        let fit = problem.solve();
        assert!((problem.loss_of(fit.roughness, fit.f0) / fit.loss - 1.0).abs() < 1e-9);
        let tried = (0..160).flat_map(|i| (1..60).map(move |j| (i, j)));
        let least = tried
            .map(|(i, j)| problem.loss_of(0.2 + 0.005 * f64::from(i), 0.02 * f64::from(j)))
            .fold(f64::INFINITY, f64::min);
        assert!(
            fit.loss <= least * (1.0 + 1e-6),
            "{}: {} {least}",
            loss.name(),
            fit.loss
        );
    }
}

#[test]
fn limits_of_width_and_f0_are_reported() {
    let family = family();
    let is_at_limit = |values: Vec<f64>, loss: Loss| {
        let photo = photo(values);
        let problem = Problem {
            lines: &family,
            photo: &photo,
            loss,
        };
        problem.is_at_limit(&problem.solve())
    };
    for loss in [Loss::Relative, Loss::Nvdiffrec] {
        assert!(!is_at_limit(lines(0.5).at(0.5).collect(), loss));
        // The widths of the grid from 0.2 do not reach it.
        assert!(is_at_limit(lines(0.19).at(0.5).collect(), loss));
        let bright: Vec<f64> = lines(0.5).at(2.0 * F0_MAX).collect();
        assert!(is_at_limit(bright, loss));
    }
}

#[test]
fn two_images_give_the_lines_in_f0() {
    let lines = lines(0.4);
    let [a, b]: [Vec<f64>; 2] = [0.04, 1.0].map(|f0| lines.at(f0).collect());
    let through = Lines::through(0.4, [(0.04, &a), (1.0, &b)]);
    for (found, due) in through.at(0.6).zip(lines.at(0.6)) {
        assert!((found - due).abs() < 1e-14);
    }
}

pub const EXPERIMENT: &str = r#"
name = "recovered"
asks = ["recovery"]
size = [24, 24]
reference = "none"
[axes]
environment = ["builtin:constant", "builtin:sky"]
environment_orientation = [0, 3]
method = ["reference", "split-sum", "split-sum-two", "ladder-view"]
samples = [64]
perceptual_roughness = [0.2, 0.35, 0.5, 0.7]
f0 = [1, 0.25]
diffuse = ["none"]
albedo = [0]
exposure = [1, 2]
[recovery]
"#;

/// Number in a row of `recovery.csv`.
fn number(table: &splitsum::base::csv::Table, row: &[String], column: &str) -> f64 {
    row[table.column(column).unwrap()].parse().unwrap()
}

/// The synthetic renderer's images are proportional to F0, and `split-sum` is 15 % too bright or
/// exact: the F0 that it recovers is the truth over that factor.
#[test]
fn a_run_recovers_what_its_renderer_hides() {
    for (error, factor) in [(0.0, 1.0), (0.15, 1.15)] {
        let (bench, log) = (Bench::new(EXPERIMENT), log());
        log.borrow_mut().has_f0 = true;
        log.borrow_mut().split_sum_error = Some(if error == 0.0 { |_| 0.0 } else { |_| 0.15 });
        bench.invoke(&log, usize::MAX).unwrap();
        let table = bench.table("recovery.csv");
        let candidate = table.column("candidate").unwrap();
        let textbook: Vec<String> = bench
            .plan
            .cells
            .iter()
            .filter(|cell| cell.point.get("method").text() == "split-sum")
            .map(|cell| cell.id.to_string())
            .collect();
        let mut count = 0;
        for row in table
            .rows
            .iter()
            .filter(|row| textbook.contains(&row[candidate]))
        {
            let column = |name: &str| number(&table, row, name);
            assert_eq!(column("photos"), 2.0);
            let roughness = column("roughness") - column("true_roughness");
            // A band has fewer pixels, so its minimum is flatter.
            let is_whole = column("n_dot_v_from") == 0.0 && column("n_dot_v_to") == 1.0;
            let near = if is_whole { 3e-4 } else { 3e-3 };
            assert!(roughness.abs() < near, "{row:?}");
            let f0 = column("f0") * factor / column("true_f0");
            assert!((f0 - 1.0).abs() < 2.0 * near, "{row:?}");
            count += 1;
        }
        // 2 environments, 4 widths, 2 values of F0, 4 losses; all views and at least two bands.
        assert!(count >= 2 * 4 * 2 * 4 * 3, "{count}");
        // Two exposures are one linear image; a step of the ladder is a candidate, not a photo.
        let cells = table.column("cell").unwrap();
        let photos: std::collections::BTreeSet<&String> =
            table.rows.iter().map(|row| &row[cells]).collect();
        assert_eq!(photos.len(), 2 * 4 * 2);
    }
}

/// A finished run makes the table again only if it is missing.
#[test]
fn a_lost_table_is_made_again() {
    let bench = Bench::finished(EXPERIMENT);
    let (before, path) = (bench.read("recovery.csv"), bench.path("recovery.csv"));
    std::fs::remove_file(&path).unwrap();
    let (notes, renders) = bench.again().unwrap();
    assert_eq!(
        (notes.as_slice(), renders.len()),
        (&["fitting materials to the photos".to_owned()][..], 0)
    );
    assert_eq!(bench.read("recovery.csv"), before);
    assert!(bench.again().unwrap().0.is_empty());
}

#[test]
fn what_a_fit_lacks_is_named() {
    let fault = |from: &str, to: &str| {
        let text = EXPERIMENT.replace(from, to);
        let path = std::path::Path::new("x.toml");
        splitsum::experiment::Plan::from_text(path, &text, &[])
            .expect_err("a fault")
            .to_string()
    };
    for (from, to, lack) in [
        ("reference = \"none\"\n", "", "reference = \"none\""),
        ("\"reference\", ", "", "reference in the axis method"),
        ("0.2, 0.35, 0.5, 0.7", "0.2, 0.35", "at least 3 widths"),
        ("f0 = [1, 0.25]", "f0 = [1]", "two values in the axis f0"),
    ] {
        let fault = fault(from, to);
        assert!(
            fault.contains("[recovery] needs") && fault.contains(lack),
            "{fault}"
        );
        assert_eq!(fault.lines().count(), 1, "{fault}");
    }
    let loss = fault("[recovery]", "[recovery]\nlosses = [\"nvdiffrek\"]");
    assert!(
        loss.contains("nvdiffrek") && loss.contains("nvdiffrec"),
        "{loss}"
    );
}
