//! Point sequences: inside the square, even, and independent between sets.

use crate::chi_square::chi_square_tail;
use glam::DVec2;
use splitsum::base::math::sequence::{PixelPoints, SEQUENCES, Sequence, scrambled};
use splitsum::base::names::Listed;
use splitsum::instrument::precompute::points;
use splitsum::instrument::precompute::prefilter::level_bias::LEVEL_BIASES;
use std::f64::consts::PI;

fn set(name: &str, count: u32, set: u32) -> Vec<DVec2> {
    let sequence = Sequence::listed(name);
    (0..count)
        .map(|i| (sequence.point)(i, count, set))
        .collect()
}

#[test]
fn no_point_has_a_coordinate_of_0_or_1_in_f32() {
    for sequence in SEQUENCES {
        for set in 0..20 {
            for [u, cos_phi, sin_phi, log] in
                points::table(1000, sequence, set, PixelPoints::Shared)
            {
                assert!(u > 0.0 && u < 1.0, "{} set {set}: {u}", sequence.name);
                assert!(
                    (cos_phi.hypot(sin_phi) - 1.0).abs() < 1e-6 && log > 0.0 && log.is_finite()
                );
            }
        }
    }
}

/// Every dyadic rectangle of area 1 / n holds exactly one of n = 2^m points: the net property that
/// Owen scrambling keeps.
#[test]
fn scrambled_sobol_points_are_a_net_in_every_set() {
    for (m, k) in [(4, 0), (7, 3), (10, 12345)] {
        let points = set("sobol-owen", 1 << m, k);
        for columns in 0..=m {
            let mut counts = vec![0; 1 << m];
            for p in &points {
                let x = (p.x * f64::from(1 << columns)) as usize;
                let y = (p.y * f64::from(1 << (m - columns))) as usize;
                counts[(y << columns) + x] += 1;
            }
            assert!(
                counts.iter().all(|count| *count == 1),
                "m = {m}, set {k}, {columns} bits of x"
            );
        }
    }
    assert_ne!(set("sobol-owen", 16, 0), set("sobol-owen", 16, 1));
}

/// Sum of (count - mean)² / mean over a grid of cells; for independent points its mean is the
/// number of cells less 1.
fn chi_square(points: &[DVec2], side: usize) -> f64 {
    let mut counts = vec![0.0; side * side];
    for p in points {
        counts[(p.y * side as f64) as usize * side + (p.x * side as f64) as usize] += 1.0;
    }
    let mean = points.len() as f64 / counts.len() as f64;
    counts
        .iter()
        .map(|count: &f64| (count - mean).powi(2) / mean)
        .sum()
}

#[test]
fn random_points_are_as_uneven_as_chance_and_the_others_far_less() {
    // 255 degrees of freedom: standard deviation sqrt(510), so these are 5 of them.
    for k in 0..10 {
        let random = chi_square(&set("random", 4096, k), 16);
        assert!(
            (random - 255.0).abs() < 5.0 * 510f64.sqrt(),
            "set {k}: {random}"
        );
    }
    for name in ["hammersley", "sobol-owen", "r2"] {
        assert!(chi_square(&set(name, 4096, 3), 16) < 50.0, "{name}");
    }
}

/// A scrambled net is a net; scrambles of pixels and sets differ, and over them each point is
/// uniform, so estimates are unbiased.
#[test]
fn scrambled_points_of_pixels_are_uniform_nets_of_their_own() {
    let plain = set("hammersley", 64, 0);
    let of = |pixel, set: u32| -> Vec<DVec2> {
        plain.iter().map(|p| scrambled(*p, pixel, set)).collect()
    };
    for (pixel, set) in [([0, 0], 0), ([5, 0], 0), ([0, 5], 0), ([5, 0], 1)] {
        let points = of(pixel, set);
        for columns in [1, 2, 4, 8, 16, 32, 64] {
            let cells = DVec2::new(columns.into(), f64::from(64 / columns));
            let mut seen: Vec<[u32; 2]> = points
                .iter()
                .map(|p| (*p * cells).as_uvec2().to_array())
                .collect();
            seen.sort_unstable();
            seen.dedup();
            assert_eq!(seen.len(), 64, "{pixel:?} {set}: {columns} columns");
        }
    }
    for (pixel, set) in [([5, 0], 0), ([0, 5], 0), ([0, 0], 1)] {
        assert_ne!(of([0, 0], 0), of(pixel, set), "{pixel:?} {set}");
    }
    for point in [plain[0], plain[63], DVec2::splat(0.5)] {
        let over_pixels: Vec<DVec2> = (0..4096)
            .map(|i| scrambled(point, [i % 64, i / 64], 3))
            .collect();
        let over_sets: Vec<DVec2> = (0..4096).map(|set| scrambled(point, [9, 2], set)).collect();
        for points in [over_pixels, over_sets] {
            let statistic = chi_square(&points, 16);
            let tail = chi_square_tail(statistic, 255.0);
            assert!(tail > 1e-4 && tail < 1.0 - 1e-4, "{point}: {statistic}");
        }
    }
}

/// The mean over sets estimates the integral without bias, and with far less noise than random
/// points.
#[test]
fn randomised_sets_are_unbiased_repetitions() {
    let integrand = |p: DVec2| p.x * p.y * p.y + if p.x + p.y > 1.2 { 1.0 } else { 0.0 };
    let truth = 1.0 / 6.0 + 0.8 * 0.8 / 2.0;
    let mut deviations = Vec::new();
    for sequence in SEQUENCES {
        let means: Vec<f64> = (1..=400)
            .map(|k| {
                set(sequence.name, 64, k)
                    .iter()
                    .map(|p| integrand(*p))
                    .sum::<f64>()
                    / 64.0
            })
            .collect();
        let mean = means.iter().sum::<f64>() / means.len() as f64;
        let deviation = (means.iter().map(|x| (x - mean).powi(2)).sum::<f64>()
            / (means.len() - 1) as f64)
            .sqrt();
        let z = (mean - truth) / (deviation / (means.len() as f64).sqrt());
        assert!(
            z.abs() < 4.0,
            "{}: {mean} is {z} standard errors from {truth}",
            sequence.name
        );
        deviations.push((sequence.name, deviation));
    }
    let random = deviations
        .iter()
        .find(|(name, _)| *name == "random")
        .unwrap()
        .1;
    assert!(
        deviations
            .iter()
            .all(|(name, d)| *name == "random" || *d < 0.5 * random),
        "{deviations:?}"
    );
}

#[test]
fn level_biases_follow_their_engines_formulas() {
    // MaterialX takes level log2(W) - 1.5 - 1/2 log2(N p sin θ) for 1/2 log2(W² / (4 π² N p sin
    // θ)), W x W/2 texels; Godot a texel of 4π / 6w² where one of 4π / w² is meant.
    let powers = [1.0, 4.0, 4.0 * PI * PI / 8.0, 6.0, 4.0 * PI];
    for (bias, power) in LEVEL_BIASES.iter().zip(powers) {
        assert!(
            (bias.levels - 0.5 * f64::log2(power)).abs() < 1e-14,
            "{}: {}",
            bias.name,
            bias.levels
        );
    }
    assert_eq!(LEVEL_BIASES.len(), powers.len());
}
