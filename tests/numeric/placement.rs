//! The rotations of the light: a fixed low-discrepancy set.

use glam::{DMat3, DQuat, DVec3};
use splitsum::instrument::environment::{Placement, orientation};

fn all(count: u32) -> Vec<DMat3> {
    (0..count).map(orientation).collect()
}

#[test]
fn orientations_are_distinct_proper_rotations() {
    let all = all(Placement::ORIENTATION_MAX + 1);
    assert_eq!(all[0], DMat3::IDENTITY);
    for r in &all {
        assert!(
            (*r * r.transpose()).abs_diff_eq(DMat3::IDENTITY, 1e-14)
                && (r.determinant() - 1.0).abs() < 1e-14
        );
    }
    // A 4,096th of SO(3) is a ball of 9.5 degrees; the nearest two rotations are not copies.
    let angle = |a: &DMat3, b: &DMat3| {
        ((a.transpose() * *b)
            .to_cols_array()
            .iter()
            .step_by(4)
            .sum::<f64>()
            - 1.0)
            / 2.0
    };
    let nearest = all
        .iter()
        .enumerate()
        .flat_map(|(i, a)| all[..i].iter().map(move |b| angle(a, b)));
    let nearest = nearest.fold(-1.0, f64::max).acos().to_degrees();
    println!("nearest two: {nearest} degrees");
    assert!(nearest > 1.0, "{nearest}");
}

/// The first one by the definition: x = fract(1/2 + 1/g), and so on, as (√(1-x) sin 2πy, √(1-x) cos
/// 2πy, √x sin 2πz, √x cos 2πz).
#[test]
fn the_first_orientation_is_the_first_point_as_a_quaternion() {
    let mut g = 1.2f64;
    (0..50).for_each(|_| g = (1.0 + g).sqrt().sqrt());
    let [x, y, z] = [1, 2, 3].map(|power| (0.5 + g.powi(-power)).fract());
    let [y, z] = [y, z].map(|turns| std::f64::consts::TAU * turns);
    let ([s, c], [a, b]) = ([(1.0 - x).sqrt(), x.sqrt()], [y.sin(), z.sin()]);
    let q = DQuat::from_xyzw(s * a, s * y.cos(), c * b, c * z.cos());
    for d in [DVec3::X, DVec3::Y, DVec3::Z] {
        // q d q*.
        let turned = (q * DQuat::from_vec4(d.extend(0.0)) * q.conjugate()).xyz();
        assert!(
            (orientation(1) * d).abs_diff_eq(turned, 1e-13),
            "{d}: {} for {turned}",
            orientation(1) * d
        );
    }
}

/// Over the irreducible representations of SO(3): the mean square of the means of all functions of
/// degree l, over its expectation for independent rotations. 1 is random, 0 even.
#[test]
fn every_prefix_is_more_even_than_chance() {
    for count in [64u32, 256, 1024] {
        let all = all(count);
        let mut sums = [0.0; 6];
        for (i, a) in all.iter().enumerate() {
            for b in &all[..i] {
                let cos = ((a.transpose() * *b)
                    .to_cols_array()
                    .iter()
                    .step_by(4)
                    .sum::<f64>()
                    - 1.0)
                    / 2.0;
                let half = cos.clamp(-1.0, 1.0).acos() / 2.0;
                for (l, sum) in sums.iter_mut().enumerate() {
                    let dimension = (2 * l + 3) as f64;
                    // The character of degree l + 1.
                    let character = if half < 1e-6 {
                        dimension
                    } else {
                        (dimension * half).sin() / half.sin()
                    };
                    *sum += 2.0 * character / dimension / f64::from(count);
                }
            }
        }
        let ratios = sums.map(|sum| 1.0 + sum);
        println!("{count}: {ratios:.3?}");
        // A degree has (2 l + 1)² functions; few points can be even for fewer functions only.
        let is_held = |l: usize| 5 * (2 * l + 3).pow(2) <= count as usize;
        assert!(
            (0..6).all(|l| !is_held(l) || ratios[l] < 0.5),
            "{count}: {ratios:.3?}"
        );
    }
}
