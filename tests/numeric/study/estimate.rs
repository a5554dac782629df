//! Intervals over environments, compared with simulated studies whose truth is known.

use fastrand::Rng;
use splitsum::experiment::value::Value;
use splitsum::study::frame::estimate::{Middle, estimate};
use std::f64::consts::TAU;

/// Studies of one kind. The standard error of a coverage of 0.95 is then 0.005.
const STUDIES: usize = 2000;
const LIMITS: [f64; 2] = [0.93, 0.97];
const ENVIRONMENTS: [usize; 3] = [6, 10, 20];

/// A normal deviate (Box-Muller).
pub fn normal(random: &mut Rng) -> f64 {
    let radius = (-2.0 * random.f64().max(f64::MIN_POSITIVE).ln()).sqrt();
    radius * (TAU * random.f64()).cos()
}

/// Standard deviations of the logarithm of a number.
#[derive(Clone, Copy)]
struct Spread {
    /// Between environments.
    light: f64,
    /// Between models and between alphas within an environment.
    model: f64,
    alpha: f64,
    /// Between point sets of one case.
    luck: f64,
}

/// As with measured maps: they move break-even counts from 4 to 128, and models are near-copies of
/// each other.
const MEASURED: Spread = Spread {
    light: 1.0,
    model: 0.2,
    alpha: 0.5,
    luck: 0.1,
};

/// A study of three models, five alphas and four point sets under each environment. Effects are
/// normal, so the truth is 1 for the geometric mean and the median alike. A case is the mean of its
/// point sets.
fn study(random: &mut Rng, environments: usize, spread: Spread) -> Vec<(Value, f64)> {
    let mut values = Vec::new();
    for environment in 0..environments {
        let name = Value::Count(environment as u32);
        let light = spread.light * normal(random);
        let models: [f64; 3] = std::array::from_fn(|_| spread.model * normal(random));
        let alphas: [f64; 5] = std::array::from_fn(|_| spread.alpha * normal(random));
        for effect in models
            .iter()
            .flat_map(|model| alphas.iter().map(move |alpha| light + model + alpha))
        {
            let luck: f64 = (0..4).map(|_| spread.luck * normal(random) / 4.0).sum();
            values.push((name.clone(), (effect + luck).exp()));
        }
    }
    values
}

/// How often the interval of studies, transformed by `seen`, contains the truth of 1.
fn coverage(
    environments: usize,
    middle: Middle,
    seen: impl Fn(Vec<(Value, f64)>) -> Vec<(Value, f64)>,
) -> f64 {
    let mut random = Rng::with_seed(environments as u64);
    let covers = |_: &usize| {
        let rows = seen(study(&mut random, environments, MEASURED));
        let [lo, hi] = estimate(&rows, middle).unwrap().interval.unwrap();
        lo <= 1.0 && 1.0 <= hi
    };
    (0..STUDIES).filter(covers).count() as f64 / STUDIES as f64
}

#[test]
fn intervals_over_environments_have_their_stated_coverage() {
    for environments in ENVIRONMENTS {
        // Ratios are averaged over models and alphas, break-even counts at one of each.
        let mean = coverage(environments, Middle::GeometricMean, |rows| rows);
        let pooled = coverage(environments, Middle::Median, |rows| rows);
        let one = coverage(environments, Middle::Median, |rows| {
            rows.into_iter().step_by(15).collect()
        });
        for found in [mean, pooled, one] {
            assert!(
                (LIMITS[0]..=LIMITS[1]).contains(&found),
                "{environments}: {mean} {pooled} {one}"
            );
        }
    }
}

#[test]
fn prediction_intervals_hold_one_new_environment() {
    for environments in ENVIRONMENTS {
        for middle in [Middle::GeometricMean, Middle::Median] {
            let mut random = Rng::with_seed(environments as u64);
            let holds = |_: &usize| {
                let [lo, hi] = estimate(&study(&mut random, environments, MEASURED), middle)
                    .unwrap()
                    .prediction
                    .unwrap();
                let new = estimate(&study(&mut random, 1, MEASURED), middle)
                    .unwrap()
                    .value;
                lo <= new && new <= hi
            };
            let found = (0..STUDIES).filter(holds).count() as f64 / STUDIES as f64;
            assert!(
                (LIMITS[0]..=LIMITS[1]).contains(&found),
                "{environments}, {middle:?}: {found}"
            );
        }
    }
    // 0 to 5: mean 2.5, variance 3.5. Below six environments there is no interval.
    let of = |n: u32| {
        let values: Vec<_> = (0..n).map(|i| (Value::Count(i), f64::from(i))).collect();
        estimate(&values, Middle::Mean).unwrap()
    };
    let half = 2.571 * (3.5f64 * (1.0 + 1.0 / 6.0)).sqrt();
    assert!((of(6).prediction.unwrap()[1] - (2.5 + half)).abs() < 1e-9 && of(6).interval.is_some());
    assert!(
        of(5).prediction.is_none()
            && of(5).interval.is_none()
            && estimate(&[], Middle::Median).is_none()
    );
}

#[test]
fn more_rows_of_one_environment_are_not_more_evidence() {
    let mut random = Rng::with_seed(5);
    let few: Vec<_> = study(&mut random, 8, MEASURED)
        .into_iter()
        .step_by(15)
        .collect();
    let many: Vec<(Value, f64)> = few.iter().flat_map(|row| vec![row.clone(); 20]).collect();
    for middle in [Middle::GeometricMean, Middle::Median] {
        let [a, b] = [&few, &many].map(|rows| estimate(rows, middle).unwrap());
        assert_eq!((a.n, b.n), (8, 8));
        let ends = a.interval.unwrap().into_iter().zip(b.interval.unwrap());
        assert!(
            ends.into_iter().all(|(a, b)| (a / b - 1.0).abs() < 1e-9),
            "{a:?} {b:?}"
        );
    }
}
