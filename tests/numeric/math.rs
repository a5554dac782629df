//! Frames, point sets, special functions, quadrature, spherical harmonics, the equirectangular
//! mapping.

use glam::{DVec2, DVec3};
use libm::{erf, erfc};
use splitsum::base::math::equirect::{direction_from_uv, texel_solid_angle, uv_from_direction};
use splitsum::base::math::erf::erf_inverse;
use splitsum::base::math::frame::Frame;
use splitsum::base::math::incomplete_beta::{gamma_ratio_half, incomplete_beta_half};
use splitsum::base::math::quadrature::{
    Bounded, GaussLegendre, Rectangle, Tolerance, integrate_columns,
};
use splitsum::base::math::sampling::{direction_from_polar, hammersley, radical_inverse_2};
use splitsum::base::math::spherical_harmonics::{COUNT, basis, irradiance};
use std::f64::consts::{PI, TAU};

/// Directions spread evenly over the sphere.
pub fn spread(count: u32) -> impl Iterator<Item = DVec3> {
    (0..count).map(move |i| {
        let xi = hammersley(i, count);
        let z = 1.0 - 2.0 * xi.x;
        direction_from_polar((1.0 - z * z).sqrt(), z, xi.y)
    })
}

/// Directions that cover the sphere, including the axes and the singular directions of frames and
/// mappings.
fn directions() -> Vec<DVec3> {
    let axes = [
        DVec3::X,
        DVec3::Y,
        DVec3::Z,
        DVec3::NEG_X,
        DVec3::NEG_Y,
        DVec3::NEG_Z,
    ];
    let near_axis = [
        DVec3::new(1e-9, 0.0, -1.0),
        DVec3::new(0.0, -1e-5, -1.0),
        DVec3::new(1e-8, 1.0, -1e-8),
    ];
    spread(200)
        .chain(axes)
        .chain(near_axis.map(|d| d.normalize()))
        .collect()
}

#[test]
fn frames_are_orthonormal_and_right_handed() {
    for n in directions() {
        let frame = Frame::from_normal(n);
        assert!(
            (frame.tangent.cross(frame.bitangent) - n).length() < 1e-14,
            "{n}"
        );
        assert!(
            (frame.tangent.length() - 1.0).abs() < 1e-14 && frame.tangent.dot(n).abs() < 1e-14,
            "{n}"
        );
        let d = DVec3::new(0.3, -0.5, 0.8);
        assert!(
            (frame.to_local(frame.to_world(d)) - d).length() < 1e-14,
            "{n}"
        );
        assert!((frame.to_local(n) - DVec3::Z).length() < 1e-14, "{n}");
    }
}

#[test]
fn equirectangular_mapping_and_its_inverse_agree() {
    for d in directions() {
        assert!(
            (direction_from_uv(uv_from_direction(d)) - d).length() < 1e-14,
            "{d}"
        );
    }
    for (uv, d) in [
        ((0.5, 0.5), DVec3::Z),
        ((0.25, 0.5), DVec3::X),
        ((0.5, 0.0), DVec3::Y),
        ((0.0, 0.5), DVec3::NEG_Z),
    ] {
        assert!((direction_from_uv(uv.into()) - d).length() < 1e-15, "{d}");
    }
    let (width, height) = (7, 5);
    let sphere: f64 = (0..height)
        .map(|j| f64::from(width) * texel_solid_angle(j, width, height))
        .sum();
    assert!((sphere - 4.0 * PI).abs() < 1e-13);
}

#[test]
fn hammersley_points_are_stratified_in_both_coordinates() {
    assert_eq!(
        [1, 2, 3, 4, u32::MAX].map(radical_inverse_2),
        [0.5, 0.25, 0.75, 0.125, 1.0 - 0.5f64.powi(32)]
    );
    assert_eq!(hammersley(1, 4), DVec2::new(0.375, 0.5));
    let count = 64;
    let points: Vec<DVec2> = (0..count).map(|i| hammersley(i, count)).collect();
    // One point in each elementary interval of the (0, 6, 2)-net: 8 x 8, 16 x 4 and 4 x 16 boxes.
    for columns in [4, 8, 16] {
        let mut boxes = vec![0; 64];
        for xi in &points {
            boxes[(xi.x * f64::from(columns)) as usize * (64 / columns as usize)
                + (xi.y * 64.0 / f64::from(columns)) as usize] += 1;
        }
        assert!(boxes.iter().all(|&n| n == 1), "{columns} columns");
    }
}

#[test]
fn error_function_and_its_inverse_match_published_digits() {
    // Abramowitz and Stegun, table 7.1; NIST DLMF 7.
    for (x, value) in [
        (0.1, 0.112_462_916_018_284_9),
        (0.5, 0.520_499_877_813_046_5),
        (1.0, 0.842_700_792_949_714_9),
        (2.0, 0.995_322_265_018_952_7),
    ] {
        assert!(
            (erf(x) - value).abs() < 3e-16 && (erf(-x) + value).abs() < 3e-16,
            "erf({x}) = {}",
            erf(x)
        );
    }
    // The tail keeps its relative precision.
    for (x, value) in [
        (3.0, 2.209_049_699_858_544e-5),
        (5.0, 1.537_459_794_428_035e-12),
        (26.0, 5.663_192_408_856_143e-296),
    ] {
        assert!(
            (erfc(x) / value - 1.0).abs() < 5e-16,
            "erfc({x}) = {}",
            erfc(x)
        );
    }
    for x in [1e-3, 0.5, 2.0, 5.0] {
        let found = erf_inverse(-erf(x), erfc(x) * (1.0 + erf(x)));
        assert!(
            (found + x).abs() < 1e-14 * x.max(0.1),
            "erf_inverse(erf({})) = {found}",
            -x
        );
    }
}

#[test]
fn gauss_legendre_is_exact_to_its_degree_and_no_further() {
    let rule = GaussLegendre::<6>::new();
    let error = |degree: i32| {
        rule.integrate(0.0, 2.0, |x| x.powi(degree))
            / (2f64.powi(degree + 1) / f64::from(degree + 1))
            - 1.0
    };
    (0..=11).for_each(|degree| assert!(error(degree).abs() < 1e-14, "degree {degree}"));
    assert!(error(12).abs() > 1e-8);
    for (k, node) in rule.nodes.iter().enumerate() {
        assert!(
            rule.lagrange(*node)
                .iter()
                .enumerate()
                .all(|(j, l)| (l - f64::from(u8::from(j == k))).abs() < 1e-14)
        );
    }
}

#[test]
fn adaptive_cubature_keeps_its_bounds_on_kinks_cliffs_and_peaks() {
    let square = Rectangle {
        low: DVec2::ZERO,
        high: DVec2::ONE,
    };
    let tolerance = Tolerance {
        relative: 1e-6,
        max_part_count: 200_000,
    };
    // A kink along a diagonal (exact 1/6), an off-centre peak of width 0.01, a smooth function.
    let peak = |x: f64| (-((x - 0.371) / 0.01).powi(2)).exp();
    let smooth = |x: &f64, y: f64| DVec3::new((x - y).max(0.0), peak(*x) * peak(y), (x * y).exp());
    let Bounded { value, error } = integrate_columns(square, tolerance, |x| x, smooth);
    let exact = DVec3::new(1.0 / 6.0, PI * 1e-4, 1.317_902_151_454_403_8);
    for k in 0..3 {
        assert!(
            (value[k] - exact[k]).abs() <= error[k] + 1e-15,
            "{k}: {} against {}, error {}",
            value[k],
            exact[k],
            error[k]
        );
        assert!(error[k] <= 1e-6 * exact.max_element().max(exact[k]));
    }
    // A cliff off every grid line: the quadrature converges slowly and states the reached error.
    let rough = Tolerance {
        relative: 1e-9,
        max_part_count: 2_000,
    };
    let cliff = |x: &f64, y: f64| DVec3::splat(f64::from(u8::from(x.hypot(y) < 1.0)));
    let Bounded { value, error } = integrate_columns(square, rough, |x| x, cliff);
    assert!(
        (value.x - PI / 4.0).abs() <= error.x && error.x > 1e-6 && error.x < 1e-2,
        "{} +- {}",
        value.x,
        error.x
    );
}

#[test]
fn spherical_harmonics_are_orthonormal() {
    let rule = GaussLegendre::<6>::new();
    for a in 0..COUNT {
        for b in 0..COUNT {
            let product = rule.integrate(-1.0, 1.0, |z| {
                let ring = |i: u32| {
                    let y = basis(direction_from_polar(
                        (1.0 - z * z).sqrt(),
                        z,
                        f64::from(i) / 8.0,
                    ));
                    y[a] * y[b]
                };
                TAU / 8.0 * (0..8).map(ring).sum::<f64>()
            });
            assert!(
                (product - f64::from(u8::from(a == b))).abs() < 1e-14,
                "{a} {b}: {product}"
            );
        }
    }
    // Order and signs of source document 0: y, z, x; xy, yz, 3z² - 1, xz, x² - y²; all constants
    // positive.
    let y = basis(DVec3::new(0.48, 0.6, 0.64));
    assert!(
        (y[1] / y[2] - 0.6 / 0.64).abs() < 1e-15
            && (y[3] / y[2] - 0.48 / 0.64).abs() < 1e-15
            && y[1] > 0.0
    );
    assert!(
        (y[4] / y[5] - 0.48 / 0.64).abs() < 1e-15
            && (y[7] / y[5] - 0.48 / 0.6).abs() < 1e-15
            && y[4] > 0.0
    );
    assert!(basis(DVec3::Z)[6] > 0.0 && basis(DVec3::X)[8] > 0.0);
}

#[test]
fn irradiance_of_radiance_up_to_degree_two_is_the_cosine_integral() {
    // L = 1 gives π; L = n·d gives the first-degree factor; both by the definition of A_l.
    let mut one = [DVec3::ZERO; COUNT];
    one[0] = DVec3::splat((4.0 * PI).sqrt());
    assert!((irradiance(&one, DVec3::Y) - DVec3::splat(PI)).length() < 1e-14);
    // Every function alone: quadrature of Y(l) max(n·l, 0) about a skew normal.
    let n = DVec3::new(0.36, -0.48, 0.8);
    let frame = Frame::from_normal(n);
    let rule = GaussLegendre::<6>::new();
    for k in 0..COUNT {
        let mut coefficients = [DVec3::ZERO; COUNT];
        coefficients[k] = DVec3::ONE;
        let exact = rule.integrate(0.0, 1.0, |z| {
            let ring = |i: u32| {
                basis(frame.to_world(direction_from_polar(
                    (1.0 - z * z).sqrt(),
                    z,
                    f64::from(i) / 8.0,
                )))[k]
            };
            TAU / 8.0 * z * (0..8).map(ring).sum::<f64>()
        });
        assert!(
            (irradiance(&coefficients, n).x - exact).abs() < 1e-14,
            "{k}"
        );
    }
}

#[test]
fn incomplete_beta_of_one_half() {
    // Whole n: ∫ sin^(2n-1) is a polynomial in the cosine.
    for c in [0.0f64, 1e-9, 0.01, 0.3, 0.5, 0.9, 0.999, 1.0] {
        let closed = [
            (1.0, 1.0 - c),
            (2.0, 1.0 - (3.0 * c - c.powi(3)) / 2.0),
            (
                3.0,
                1.0 - (15.0 * c - 10.0 * c.powi(3) + 3.0 * c.powi(5)) / 8.0,
            ),
        ];
        for (n, expected) in closed {
            let value = incomplete_beta_half(n, c);
            assert!(
                (value - expected).abs() < 1e-14,
                "n {n} c {c}: {value} {expected}"
            );
        }
        // The jump of the recurrence where the series takes over, from both sides.
        for n in [1.5, 24.5, 25.0, 30.25] {
            let term =
                ((n * (-c * c).ln_1p()).exp() * c * gamma_ratio_half(n) / (n * PI.sqrt())).max(0.0);
            let step = incomplete_beta_half(n, c) - incomplete_beta_half(n + 1.0, c);
            assert!((step - term).abs() < 2e-15, "n {n} c {c}: {step} {term}");
        }
    }
    // Large n: the complementary error function, with the first term of the expansion in 1/n.
    for z in [0.1, 0.7, 2.0] {
        let n = 1e6;
        let c = (-(-z * z / (n - 0.25f64)).exp_m1()).sqrt();
        assert!((incomplete_beta_half(n, c) - erfc(z)).abs() < 1e-12);
    }
    // Γ(3/2)/Γ(1) = √π/2, Γ(5/2)/Γ(2) = 3√π/4, and n - 1/4 under the root for large n.
    assert!((gamma_ratio_half(1.0) / (0.5 * PI.sqrt()) - 1.0).abs() < 2e-15);
    assert!((gamma_ratio_half(2.0) / (0.75 * PI.sqrt()) - 1.0).abs() < 2e-15);
    assert!((gamma_ratio_half(1e6) / 999_999.75f64.sqrt() - 1.0).abs() < 1e-13);
}
