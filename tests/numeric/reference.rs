//! The reference integrator: its points and its environment distribution.

use crate::chi_square::{fit, xi};
use crate::environment_sampling::Sampling;
use crate::oracle::lookup;
use fastrand::Rng;
use glam::{DVec2, DVec3};
use sobol_burley::parts::{owen_scramble_rev, sobol_rev};
use splitsum::base::color::{REC709_LUMINANCE, luminance};
use splitsum::base::glsl::constants::{
    LUMINANCE_BLUE, LUMINANCE_GREEN, LUMINANCE_RED, SCRAMBLE_COUNT,
};
use splitsum::base::math::equirect::{direction_from_uv, uv_from_direction};
use splitsum::base::math::quadrature::GaussLegendre;
use splitsum::base::math::sequence::{hash, scramble_reversed, sobol_second_reversed};
use splitsum::base::pixels::RgbImage;
use splitsum::instrument::environment::distribution::COMPENSATION;
use splitsum::instrument::shade::reference_pass::pair_count;
use std::f64::consts::PI;

// ---- Points: shaders/lib/sobol.glsl, line by line ----

fn sobol_key(pixel: [u32; 2], scramble: u32, seed: u32, stream: u32) -> u32 {
    let chain = |key: u32, value: u32| hash(value.wrapping_add(key));
    let seeded = chain(hash(stream + 1), seed);
    chain(chain(chain(seeded, scramble), pixel[1]), pixel[0])
}

fn sobol_point(index: u32, key: [u32; 2]) -> [u32; 2] {
    let reversed = [index, sobol_second_reversed(index)];
    [0, 1].map(|d| scramble_reversed(reversed[d], key[d]).reverse_bits())
}

fn sobol_next_pair_key(key: &mut u32) -> [u32; 2] {
    let first = hash(key.wrapping_add(1));
    *key = hash(first.wrapping_add(1));
    [first, *key]
}

/// The keys of the lobe's pair and of the environment's.
fn pair_keys(pixel: [u32; 2], scramble: u32) -> [[u32; 2]; 2] {
    let mut key = sobol_key(pixel, scramble, 1, 0);
    [0, 1].map(|_| sobol_next_pair_key(&mut key))
}

fn to_unit(point: [u32; 2]) -> DVec2 {
    DVec2::new(f64::from(point[0]) + 0.5, f64::from(point[1]) + 0.5) / 2f64.powi(32)
}

#[test]
fn sobol_dimensions_equal_a_published_generator() {
    for index in 0..=0xffffu32 {
        assert_eq!(
            index,
            sobol_rev(index.reverse_bits(), 0),
            "first dimension of point {index}"
        );
        assert_eq!(
            sobol_second_reversed(index),
            sobol_rev(index.reverse_bits(), 1),
            "second dimension of point {index}"
        );
    }
    let mut random = Rng::with_seed(11);
    for _ in 0..1000 {
        let [x, key] = [0, 1].map(|_| (random.f64() * 2f64.powi(32)) as u32);
        assert_eq!(
            scramble_reversed(x, key),
            owen_scramble_rev(x, key),
            "scramble of {x:#x} by {key:#x}"
        );
    }
}

/// Each point must be uniform over scrambles, or the estimates of scrambles would be biased. Points
/// of two pairs or of two neighbours must be independent, or their errors could not be added.
#[test]
fn one_point_is_uniform_over_scrambles() {
    const SIDE: f64 = 16.0;
    const COUNT: u32 = 40_000;
    type Choose = fn([DVec2; 2], [DVec2; 2]) -> DVec2;
    let joint: [(&str, Choose); 5] = [
        ("lobe", |here, _| here[0]),
        ("environment", |here, _| here[1]),
        ("lobe and environment, first", |here, _| {
            DVec2::new(here[0].x, here[1].x)
        }),
        ("lobe second, environment first", |here, _| {
            DVec2::new(here[0].y, here[1].x)
        }),
        ("neighbours", |here, there| {
            DVec2::new(here[0].x, there[0].x)
        }),
    ];
    for index in [0, 1, 2, 3, 100] {
        for (name, choose) in joint {
            let mut bins = vec![0.0; (SIDE * SIDE) as usize];
            for scramble in 0..COUNT {
                let [here, there] = [[3, 7], [4, 7]].map(|pixel| {
                    pair_keys(pixel, scramble).map(|key| to_unit(sobol_point(index, key)))
                });
                let bin = choose(here, there) * SIDE;
                bins[(bin.y.floor() * SIDE + bin.x.floor()) as usize] += 1.0;
            }
            let tail = fit(
                &bins,
                &vec![f64::from(COUNT) / bins.len() as f64; bins.len()],
            );
            assert!(
                tail > 1e-4,
                "point {index}, {name}: probability of so bad a fit {tail:e}"
            );
        }
    }
}

// ---- Environment distribution ----

/// Smooth light of all orders with one sun across the seam and one at the lower pole.
fn lively(width: u32, height: u32) -> RgbImage {
    RgbImage::from_fn(width, height, |x, y| {
        let (u, v) = (
            (f64::from(x) + 0.5) / f64::from(width),
            (f64::from(y) + 0.5) / f64::from(height),
        );
        let base = (0.3 + (9.0 * u).sin().abs() + 0.5 * (7.0 * v).cos().abs()) as f32;
        let sun = if x == width - 1 && y == height / 2 {
            60.0
        } else {
            0.0
        };
        let pole = if y == height - 1 { 5.0 } else { 0.0 };
        [base + sun, 0.7 * base + pole, 0.2 + 0.1 * base + sun]
    })
}

fn one_hot(width: u32, height: u32, texel: [u32; 2]) -> RgbImage {
    RgbImage::from_fn(width, height, |x, y| {
        if [x, y] == texel {
            [3.0, 2.0, 1.0]
        } else {
            [0.0; 3]
        }
    })
}

/// `∫ f dω` over the rectangles of half a texel, inside which bilinear radiance is smooth, poles
/// and seam included.
fn integrate_cells(width: u32, height: u32, f: impl Fn(DVec3) -> f64) -> f64 {
    let rule = GaussLegendre::<8>::new();
    let (du, dv) = (0.5 / f64::from(width), 0.5 / f64::from(height));
    let mut sum = 0.0;
    for i in 0..2 * width {
        for j in 0..2 * height {
            let (u, v) = (f64::from(i) * du, f64::from(j) * dv);
            sum += rule.integrate(u, u + du, |u| {
                rule.integrate(v, v + dv, |v| {
                    2.0 * PI * PI * (PI * v).sin() * f(direction_from_uv(DVec2::new(u, v)))
                })
            });
        }
    }
    sum
}

/// A guide that changes fast from cell to cell.
fn lopsided(d: DVec3) -> f64 {
    0.01 + (4.0 * d.x + 2.0 * d.y).exp()
}

#[test]
fn both_languages_weigh_luminance_alike() {
    assert_eq!(
        [LUMINANCE_RED, LUMINANCE_GREEN, LUMINANCE_BLUE],
        REC709_LUMINANCE.map(|weight| weight as f32)
    );
}

#[test]
fn the_density_integrates_to_one() {
    let maps = [
        lively(16, 8),
        lively(7, 5),
        lively(1, 1),
        lively(2, 3),
        one_hot(8, 4, [0, 2]),
        one_hot(8, 4, [7, 1]),
        one_hot(8, 4, [3, 0]),
        one_hot(8, 4, [5, 3]),
    ];
    for image in maps {
        let distribution = Sampling::new(&image);
        for guide in [distribution.guide(|_| 1.0), distribution.guide(lopsided)] {
            let integral = integrate_cells(image.width, image.height, |d| {
                distribution.guided_pdf(&guide, d)
            });
            assert!(
                (integral - 1.0).abs() < 1e-9,
                "{} x {}: {integral}",
                image.width,
                image.height
            );
        }
    }
}

#[test]
fn the_density_is_the_weight_over_a_band_constant() {
    let image = lively(64, 32);
    for compensation in [0.0, COMPENSATION] {
        let distribution = Sampling::with_compensation(&image, compensation);
        let mean = integrate_cells(64, 32, |d| {
            luminance(lookup(&image, d).as_vec3().to_array())
        }) / (4.0 * PI);
        // The weights of the texels as an image: their bilinear interpolation is the ideal density.
        let weights =
            image.map(|texel| [(luminance(texel) - compensation * mean).max(0.0) as f32; 3]);
        let total = integrate_cells(64, 32, |d| lookup(&weights, d).x);
        let mut random = Rng::with_seed(3);
        for _ in 0..2000 {
            let d = direction_from_uv(DVec2::new(random.f64(), 0.1 + 0.8 * random.f64()));
            let ideal = lookup(&weights, d).x / total;
            // The mean sine of a band against the sine: half a band times the cotangent, at v =
            // 0.1. In the threshold, the mean of the texels against the mean of the interpolation.
            let tolerance = (0.5 / 32.0 * PI * 3.1 + 0.01) * ideal + 0.01 / (4.0 * PI);
            assert!(
                (distribution.pdf(d) - ideal).abs() < tolerance,
                "{d}: {} against {ideal}",
                distribution.pdf(d)
            );
        }
        let bright = (0..256).filter(|i| {
            distribution.pdf(direction_from_uv(DVec2::new(f64::from(*i) / 256.0, 0.22))) > 0.0
        });
        assert_eq!(
            bright.count() == 256,
            compensation == 0.0,
            "a threshold leaves dim light to the lobe"
        );
    }
}

#[test]
fn samples_carry_the_density_of_their_direction() {
    for image in [
        lively(16, 8),
        lively(7, 5),
        lively(1, 1),
        one_hot(8, 4, [0, 2]),
        one_hot(8, 4, [3, 0]),
    ] {
        let distribution = Sampling::new(&image);
        let guide = distribution.guide(lopsided);
        let mut random = Rng::with_seed(5);
        for _ in 0..5000 {
            let (d, pdf) = distribution.sample(xi(&mut random));
            assert!((d.length() - 1.0).abs() < 1e-12);
            assert!(
                (distribution.pdf(d) / pdf - 1.0).abs() < 1e-6,
                "{d}: {} and {pdf}",
                distribution.pdf(d)
            );
            let (d, pdf) = distribution.guided_sample(&guide, xi(&mut random));
            assert!(
                (distribution.guided_pdf(&guide, d) / pdf - 1.0).abs() < 1e-6,
                "guided {d}: {pdf}"
            );
        }
    }
}

/// Samples in bins of (u, v) that do not align with texels, against the integral of the density
/// over each bin.
#[test]
fn samples_follow_the_density() {
    const COLUMNS: usize = 11;
    const ROWS: usize = 9;
    const COUNT: usize = 60_000;
    for (image, seed) in [
        (lively(16, 8), 1),
        (lively(75, 38), 8),
        (lively(7, 5), 2),
        (lively(1, 3), 3),
        (one_hot(8, 4, [0, 2]), 4),
        (one_hot(8, 4, [7, 1]), 5),
        (one_hot(8, 4, [3, 0]), 6),
        (one_hot(8, 4, [5, 3]), 7),
    ] {
        const FINE: usize = 160;
        let distribution = Sampling::new(&image);
        let guide = if seed % 2 == 0 {
            distribution.guide(lopsided)
        } else {
            distribution.guide(|_| 1.0)
        };
        let mut expected = vec![0.0; COLUMNS * ROWS];
        for i in 0..COLUMNS * FINE {
            for j in 0..ROWS * FINE {
                let place = DVec2::new(i as f64 + 0.5, j as f64 + 0.5)
                    / DVec2::new(COLUMNS as f64, ROWS as f64)
                    / FINE as f64;
                let area =
                    2.0 * PI * PI * (PI * place.y).sin() / (COLUMNS * ROWS * FINE * FINE) as f64;
                expected[j / FINE * COLUMNS + i / FINE] +=
                    COUNT as f64 * area * distribution.guided_pdf(&guide, direction_from_uv(place));
            }
        }
        let mut observed = vec![0.0; COLUMNS * ROWS];
        let mut random = Rng::with_seed(seed);
        for _ in 0..COUNT {
            let uv = uv_from_direction(distribution.guided_sample(&guide, xi(&mut random)).0);
            let column = ((uv.x * COLUMNS as f64) as usize).min(COLUMNS - 1);
            observed[((uv.y * ROWS as f64) as usize).min(ROWS - 1) * COLUMNS + column] += 1.0;
        }
        let tail = fit(&observed, &expected);
        assert!(
            tail > 1e-4,
            "map {seed}: probability of so bad a fit {tail:e}"
        );
    }
}

#[test]
fn a_black_environment_has_no_density() {
    let distribution = Sampling::new(&RgbImage::filled(6, 3, [0.0; 3]));
    assert_eq!(distribution.tables.band_weights[0], 0.0);
    for i in 0..64 {
        let xi = to_unit(sobol_point(i, [0, 0]));
        let (d, pdf) = distribution.sample(xi);
        assert!(
            d.is_finite() && pdf == 0.0 && distribution.pdf(d) == 0.0,
            "{xi}: {d} with {pdf}"
        );
    }
    assert!(Sampling::new(&one_hot(6, 3, [2, 1])).tables.band_weights[0] > 0.0);
    assert!(
        Sampling::new(&RgbImage::filled(6, 3, [0.25; 3]))
            .tables
            .band_weights[0]
            > 0.0
    );
}

/// The largest xi must not fall into dark cells behind the last bright one.
#[test]
fn the_ends_of_the_unit_square_hit_light() {
    for texel in [[0, 0], [7, 0], [0, 3], [7, 3], [4, 2]] {
        let distribution = Sampling::new(&one_hot(8, 4, texel));
        for x in [0.0, 1.0 - f64::EPSILON] {
            for y in [0.0, 1.0 - f64::EPSILON] {
                let (d, pdf) = distribution.sample(DVec2::new(x, y));
                assert!(
                    d.is_finite() && pdf.is_finite(),
                    "texel {texel:?}, xi ({x}, {y}): {d} with {pdf}"
                );
                let uv = uv_from_direction(d);
                let columns = (uv.x * 8.0 - 0.5 - f64::from(texel[0])).rem_euclid(8.0);
                assert!(
                    columns.min(8.0 - columns) <= 1.0 + 1e-6,
                    "texel {texel:?}, xi ({x}, {y}): {uv}"
                );
            }
        }
    }
}

/// Undrawn cells are refused together with their neighbours.
#[test]
fn every_count_is_exact_or_has_exact_neighbours() {
    let (mut last_drawn, mut awaited) = (None, None);
    for count in 1..=70_000 {
        match pair_count(count) {
            Ok(pairs) => {
                assert_eq!(pairs * 2 * SCRAMBLE_COUNT, count);
                assert!(
                    awaited.is_none_or(|above| above == u64::from(count)),
                    "{awaited:?} was promised before {count}"
                );
                (last_drawn, awaited) = (Some(count), None);
            }
            Err(fault) => {
                assert_eq!(fault.below, last_drawn, "{fault:?}");
                assert!(
                    awaited.is_none_or(|above| above == fault.above),
                    "{awaited:?} became {fault:?}"
                );
                awaited = Some(fault.above);
            }
        }
    }
    assert_eq!(
        pair_count(44)
            .unwrap_err()
            .to_string()
            .split("such as ")
            .last(),
        Some("40 or 48")
    );
}
