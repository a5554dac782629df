//! The harmonic transform and prefilter against closed forms and the exact integrals.

use glam::{DMat3, DVec3};
use rayon::prelude::*;
use splitsum::brdf::{Ggx, MODELS, MaskingShadowing};
use splitsum::environment::layout::LAYOUTS;
use splitsum::environment::{Environment, LoadOptions};
use splitsum::math::equirect::direction_from_uv;
use splitsum::math::harmonics::Harmonics;
use splitsum::math::quadrature::Tolerance;
use splitsum::pixels::RgbImage;
use splitsum::precompute::exact_quadrature;
use splitsum::precompute::prefilter::harmonic::{degree, factors, harmonics, level};
use splitsum::precompute::prefilter::reference::prefilter;
use splitsum::precompute::prefilter::{Kernel, WEIGHTS};
use std::f64::consts::PI;
use std::path::Path;

fn map(size: [u32; 2], value: impl Fn(DVec3) -> f64) -> RgbImage {
    RgbImage::from_fn(size[0], size[1], |x, y| {
        let uv = glam::DVec2::new((f64::from(x) + 0.5) / f64::from(size[0]), (f64::from(y) + 0.5) / f64::from(size[1]));
        [value(direction_from_uv(uv)) as f32; 3]
    })
}

/// Directions all over the sphere, both poles among them.
fn directions() -> Vec<DVec3> {
    let spread = |i: u32| {
        let z = 1.0 - 2.0 * (f64::from(i) + 0.5) / 60.0;
        let (sin, cos) = (f64::from(i) * 2.4).sin_cos();
        DVec3::new(cos * (1.0 - z * z).sqrt(), z, sin * (1.0 - z * z).sqrt())
    };
    (0..60).map(spread).chain([DVec3::Y, DVec3::NEG_Y]).collect()
}

/// Mean square difference over the mean square of the light, the largest channel.
fn relative_mse(found: impl Fn(DVec3) -> DVec3 + Sync, exact: impl Fn(DVec3) -> DVec3 + Sync) -> f64 {
    let pairs: Vec<[DVec3; 2]> = directions().par_iter().map(|d| [found(*d), exact(*d)]).collect();
    let scale = pairs.iter().map(|[_, exact]| *exact).sum::<DVec3>() / pairs.len() as f64;
    let squares = pairs.iter().map(|[a, b]| (*a - *b).powf(2.0) / (*b * *b + 0.01 * scale * scale));
    (squares.sum::<DVec3>() / pairs.len() as f64).max_element()
}

#[test]
fn factors_of_simple_kernels_have_their_closed_forms() {
    // At alpha 1 GGX is D = 1/π: with weight 1 the hemisphere, k_l = ∫_0^1 P_l; with weight n.l the cosine lobe.
    let hemisphere = factors(Kernel::new(&Ggx, &WEIGHTS[2], MaskingShadowing::Separable), 1.0, 8);
    for (l, exact) in [1.0, 0.5, 0.0, -0.125, 0.0, 0.0625, 0.0, -5.0 / 128.0].into_iter().enumerate() {
        assert!((hemisphere[l] - exact).abs() < 1e-9, "{l}: {} for {exact}", hemisphere[l]);
    }
    // 2 ∫_0^1 x P_l dx.
    let cosine = factors(Kernel::cosine(&Ggx), 1.0, 6);
    for (l, exact) in [1.0, 2.0 / 3.0, 0.25, 0.0, -1.0 / 24.0, 0.0, 1.0 / 64.0].into_iter().enumerate() {
        assert!((cosine[l] - exact).abs() < 1e-9, "{l}: {} for {exact}", cosine[l]);
    }
}

#[test]
fn constant_and_linear_light_keep_their_shape() {
    for size in [[64, 32], [50, 25]] {
        let sphere = harmonics(&map(size, |_| 3.0), 20).convolved(&[1.0; 21]);
        assert!(directions().iter().all(|d| (sphere.value(*d).x - 3.0).abs() < 1e-6));
    }
    // L = 1 + y: the mean of a lobe about r is 1 + k_1 r.y; 3e-4 is what lies between columns and rows of the map.
    for model in MODELS {
        let k = factors(Kernel::cosine(*model), 0.3, 40);
        let linear = harmonics(&map([256, 128], |d| 1.0 + d.y), 40).convolved(&k);
        assert!(
            directions().iter().all(|d| (linear.value(*d).x - (1.0 + k[1] * d.y)).abs() < 3e-4),
            "{}",
            model.name()
        );
    }
}

#[test]
fn levels_meet_the_exact_integral() {
    let options = LoadOptions { builtin_size: [128, 64], ..LoadOptions::default() };
    for name in ["builtin:sky", "builtin:cap:elevation_deg=88,half_angle_deg=3,radiance=300"] {
        let environment = Environment::load(name, Path::new("."), &options).unwrap();
        let exact = exact_quadrature(&environment.image);
        let tolerance = Tolerance { relative: 1e-5, max_part_count: 100_000 };
        let transform = harmonics(&environment.image, degree(0.03));
        for (model, weight, alpha) in [(0, 0, 0.03), (1, 1, 0.1), (2, 0, 0.0625), (0, 1, 1.0), (0, 0, 0.25)] {
            let kernel = Kernel::new(MODELS[model], &WEIGHTS[weight], MaskingShadowing::Separable);
            let smooth = transform.convolved(&factors(kernel, alpha, degree(alpha)));
            let found = relative_mse(|d| smooth.value(d), |d| prefilter(&exact, kernel, alpha, d, tolerance).value);
            assert!(found < 1e-6, "{name} {} {} {alpha}: {found}", MODELS[model].name(), WEIGHTS[weight].name);
        }
    }
}

#[test]
fn turning_the_light_turns_its_levels() {
    let turn = DMat3::from_rotation_x(1.0) * DMat3::from_rotation_z(0.4);
    let light = |d: DVec3| (4.0 * d.dot(DVec3::new(0.6, 0.0, 0.8))).exp();
    let k = factors(Kernel::cosine(&Ggx), 0.3, 64);
    let [plain, turned] =
        [DMat3::IDENTITY, turn].map(|by| harmonics(&map([512, 256], |d| light(by.transpose() * d)), 64).convolved(&k));
    let off = relative_mse(|d| turned.value(turn * d), |d| plain.value(d));
    assert!(off < 1e-8, "{off}");
}

#[test]
fn the_transform_is_linear_and_a_sun_leaves_no_texel_below_the_sky() {
    let size = [256, 128];
    let mut image = map(size, |_| 0.5);
    image.data[40 * 256 + 7] = [1e5; 3];
    let sun = harmonics(&image, degree(0.0625));
    for alpha in [0.0625, 0.25, 1.0] {
        for layout in LAYOUTS {
            let side = if layout.is_square { [32; 2] } else { [64, 32] };
            let texels = level(&sun, Kernel::cosine(&Ggx), alpha, layout, side);
            let least = texels.iter().map(|texel| texel[0]).fold(f32::INFINITY, f32::min);
            assert!(least > 0.49, "{} {alpha}: {least}", layout.name);
        }
    }
    let mean = |image: &RgbImage| harmonics(image, 8).convolved(&[1.0, 0.0]).value(DVec3::X).x;
    // One texel of solid angle 2π²/(WH) sin θ.
    let omega = 2.0 * PI * PI / (256.0 * 128.0) * (PI * 40.5 / 128.0).sin();
    let expected = 0.5 + (1e5 - 0.5) * omega / (4.0 * PI);
    assert!((mean(&image) / expected - 1.0).abs() < 1e-3, "{} for {expected}", mean(&image));
    let both = Harmonics::new(256, 128, 8, |x, y| image.data[y * 256 + x].map(|value| 2.0 * value));
    assert!((both.convolved(&[1.0, 0.0]).value(DVec3::X).x / mean(&image) - 2.0).abs() < 1e-9);
}
