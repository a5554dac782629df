//! The harmonic transform and prefilter against closed forms and the exact integrals.

use glam::{DMat3, DVec3};
use rayon::prelude::*;
use splitsum::base::math::equirect::direction_from_uv;
use splitsum::base::math::harmonics::{Harmonics, margin};
use splitsum::base::math::quadrature::Tolerance;
use splitsum::base::pixels::RgbImage;
use splitsum::instrument::brdf::{Ggx, MODELS, MaskingShadowing};
use splitsum::instrument::environment::layout::LAYOUTS;
use splitsum::instrument::environment::{Environment, LoadOptions};
use splitsum::instrument::precompute::exact_quadrature;
use splitsum::instrument::precompute::irradiance::reference::irradiance;
use splitsum::instrument::precompute::prefilter::harmonic::{
    ALPHA_MIN, DEGREE_MAX, cosine_factors, degree, degree_of_map, factors, harmonics, level,
};
use splitsum::instrument::precompute::prefilter::reference::prefilter;
use splitsum::instrument::precompute::prefilter::{Kernel, WEIGHTS};
use std::f64::consts::PI;
use std::path::Path;

fn map(size: [u32; 2], value: impl Fn(DVec3) -> f64) -> RgbImage {
    RgbImage::from_fn(size[0], size[1], |x, y| {
        let uv = glam::DVec2::new(
            (f64::from(x) + 0.5) / f64::from(size[0]),
            (f64::from(y) + 0.5) / f64::from(size[1]),
        );
        [value(direction_from_uv(uv)) as f32; 3]
    })
}

/// Directions on the whole sphere, both poles included.
fn directions() -> Vec<DVec3> {
    let spread = |i: u32| {
        let z = 1.0 - 2.0 * (f64::from(i) + 0.5) / 60.0;
        let (sin, cos) = (f64::from(i) * 2.4).sin_cos();
        DVec3::new(cos * (1.0 - z * z).sqrt(), z, sin * (1.0 - z * z).sqrt())
    };
    (0..60)
        .map(spread)
        .chain([DVec3::Y, DVec3::NEG_Y])
        .collect()
}

/// relMSE of values by direction, the largest channel.
fn relative_mse(found: &[(DVec3, DVec3)], exact: impl Fn(DVec3) -> DVec3 + Sync) -> f64 {
    let pairs: Vec<[DVec3; 2]> = found
        .par_iter()
        .map(|(d, found)| [*found, exact(*d)])
        .collect();
    let scale = pairs.iter().map(|[_, exact]| *exact).sum::<DVec3>() / pairs.len() as f64;
    let squares = pairs
        .iter()
        .map(|[a, b]| (*a - *b).powf(2.0) / (*b * *b + 0.01 * scale * scale));
    (squares.sum::<DVec3>() / pairs.len() as f64).max_element()
}

#[test]
fn factors_of_simple_kernels_have_their_closed_forms() {
    // At alpha 1 GGX is D = 1/π: with weight 1 the hemisphere, k_l = ∫_0^1 P_l; with weight n.l the
    // cosine lobe.
    let hemisphere = factors(
        Kernel::new(&Ggx, &WEIGHTS[2], MaskingShadowing::Separable),
        1.0,
        8,
    );
    for (l, exact) in [1.0, 0.5, 0.0, -0.125, 0.0, 0.0625, 0.0, -5.0 / 128.0]
        .into_iter()
        .enumerate()
    {
        assert!(
            (hemisphere[l] - exact).abs() < 1e-9,
            "{l}: {} for {exact}",
            hemisphere[l]
        );
    }
    // 2 ∫_0^1 x P_l dx.
    let cosine = cosine_factors(degree(1.0));
    for (l, exact) in [1.0, 2.0 / 3.0, 0.25, 0.0, -1.0 / 24.0, 0.0, 1.0 / 64.0]
        .into_iter()
        .enumerate()
    {
        assert!(
            (cosine[l] - exact).abs() < 1e-15,
            "{l}: {} for {exact}",
            cosine[l]
        );
    }
    let by_quadrature = factors(Kernel::cosine(&Ggx), 1.0, degree(1.0));
    for (l, (a, b)) in cosine.iter().zip(&by_quadrature).enumerate() {
        assert!(
            (a - b).abs() < 1e-9,
            "{l}: {a} by the closed form, {b} by quadrature"
        );
    }
}

/// Share of the mean square of a filtered lamp of one direction that lies beyond the degree. All
/// degrees of such a lamp are equally strong for their number; no light of positive radiance has
/// more in the high ones.
fn cut_off(kernel: Kernel, alpha: f64) -> f64 {
    let k = factors(kernel, alpha, 3 * DEGREE_MAX);
    let squares = |from: usize| {
        (from..k.len())
            .map(|l| (2 * l + 1) as f64 * k[l] * k[l])
            .sum::<f64>()
    };
    squares(degree(alpha) + 1) / squares(0)
}

/// A kernel's end at the horizon, where lobes stop being smooth.
struct HorizonEnd {
    /// The kernel just above the horizon, 1/sr; its integral is 1.
    step: f64,
    /// Its slope there, by the cosine.
    bend: f64,
    /// `∫ K² dl`.
    square: f64,
}

impl HorizonEnd {
    fn new(kernel: Kernel, alpha: f64) -> Self {
        const NODES: u32 = 20_000;
        let value = |cos: f64| {
            let half = 0.5 * cos.acos();
            let h = DVec3::new(half.sin(), 0.0, half.cos());
            kernel.brdf.d(h, alpha) * kernel.weight(alpha, cos)
        };
        // Midpoints in ln tan(γ/2), where lobes of any width have the same shape.
        let dt = (12.0 - alpha.ln()) / f64::from(NODES);
        let integral = |f: &dyn Fn(f64) -> f64| {
            let ring = |i: u32| {
                let t = -dt * (f64::from(i) + 0.5);
                2.0 * PI * dt / t.cosh().powi(2) * f(-t.tanh())
            };
            (0..NODES).map(ring).sum::<f64>()
        };
        let whole = integral(&value);
        let [near, nearer] = [1e-6, 1e-9].map(|cos| value(cos) / whole);
        Self {
            step: nearer,
            bend: (near - nearer) / 1e-6,
            square: integral(&|cos| (value(cos) / whole).powi(2)),
        }
    }

    /// Share of the kernel's mean square from one degree to another. For high l, `k_l` is `2π step
    /// √(2/(π l))/l` if l is odd, by `∫_0^1 P_l dx`, and `2π bend √(2/(π l))/l²` if it is even, by
    /// `∫_0^1 x P_l dx`; the whole mean square is `Σ (2l + 1) k_l² = 4π ∫ K² dl`.
    fn share(&self, from: usize, to: usize) -> f64 {
        let sum = |power: i32| {
            let [first, last] = [from, to].map(|degree| (degree as f64).powi(-power));
            (first - last) / f64::from(power)
        };
        2.0 * (self.step.powi(2) * sum(1) + self.bend.powi(2) * sum(3)) / self.square
    }
}

/// Beyond the highest degree the end at the horizon leaves what its step and bend leave, which
/// depends on the model's tail. The rest of a narrow lobe is small for every model, else `degree`
/// is too low.
#[test]
fn the_cut_at_the_highest_degree_belongs_to_the_horizon() {
    // Of a lobe as narrow as the highest degree allows, else far less.
    const NARROWEST: f64 = 3e-7;
    const NARROW: f64 = 1e-11;
    // Terms of higher order in 1/l.
    const HIGHER: f64 = 0.1;
    for model in MODELS {
        for weight in WEIGHTS {
            for alpha in [ALPHA_MIN, 0.02, 0.1, 0.25, 1.0] {
                let kernel = Kernel::new(*model, weight, MaskingShadowing::Separable);
                let narrow = if alpha == ALPHA_MIN {
                    NARROWEST
                } else {
                    NARROW
                };
                let share = cut_off(kernel, alpha);
                let horizon = HorizonEnd::new(kernel, alpha).share(degree(alpha), 3 * DEGREE_MAX);
                let name = format!("{} {} {alpha}", model.name(), weight.name);
                println!("{name}: {share:.2e}, {horizon:.2e} by the horizon");
                assert!(
                    (share - horizon).abs() < narrow + HIGHER * horizon,
                    "{name}: {share:e} for {horizon:e}"
                );
            }
        }
    }
}

/// `P_lm(cos θ)` by its definition's recurrence, for l = m to `degree`; the largest of them.
fn largest(m: usize, degree: usize, sin: f64) -> f64 {
    let x = (1.0 - sin * sin).sqrt();
    let mut own = ((2 * m + 1) as f64 / (4.0 * PI)).sqrt();
    (1..=m).for_each(|k| own *= ((2 * k - 1) as f64 / (2 * k) as f64).sqrt() * sin);
    let (mut last, mut most) = (0.0, own.abs());
    for l in m + 1..=degree {
        let (l, m) = (l as f64, m as f64);
        let a = ((4.0 * l * l - 1.0) / (l * l - m * m)).sqrt();
        let b = (((l - 1.0).powi(2) - m * m) / (4.0 * (l - 1.0).powi(2) - 1.0)).sqrt();
        (last, own) = (own, a * (x * own - b * last));
        most = f64::max(most, own.abs());
    }
    most
}

#[test]
fn orders_beyond_the_margin_do_not_matter_in_a_row() {
    for degree in [16, 64, 128, 300, 511, DEGREE_MAX] {
        // The margin begins here; nearer to the pole the functions are smaller.
        let sin = |m: usize| (m as f64 - margin(degree)) / degree as f64;
        let left = (0..=degree)
            .filter(|m| sin(*m) > 0.0)
            .map(|m| (largest(m, degree, sin(m)), m));
        let worst = left.fold((0.0, 0), |a, b| if b.0 > a.0 { b } else { a });
        assert!(worst.0 < 1e-12, "degree {degree}: {worst:?}");
    }
}

#[test]
fn coarse_rows_and_columns_are_points_of_the_fine_ones() {
    // A third of the rows and columns has the same centres; there are far fewer columns than
    // orders.
    let light = map([64, 32], |d| (3.0 * d.x + d.y).exp());
    let transform = harmonics(&light, 40);
    let k = factors(Kernel::cosine(&Ggx), 0.3, 40);
    for [width, height] in [[16, 8], [7, 5], [12, 3], [1, 1], [9, 2]] {
        let (coarse, fine) = (
            transform.synthesized(&k, width, height),
            transform.synthesized(&k, 27 * width, 27 * height),
        );
        let smooth = transform.convolved(&k);
        for (i, value) in coarse.iter().enumerate() {
            let [x, y] = [i % width, i / width];
            let same = fine[(27 * y + 13) * 27 * width + 27 * x + 13];
            assert!(
                (*value - same).abs().max_element() < 1e-12,
                "{width}x{height} {x} {y}: {value} for {same}"
            );
            let uv = glam::DVec2::new(
                (x as f64 + 0.5) / width as f64,
                (y as f64 + 0.5) / height as f64,
            );
            let between = smooth.value(direction_from_uv(uv));
            assert!(
                (*value - between).abs().max_element() < 1e-4,
                "{width}x{height} {x} {y}: {value} and {between}"
            );
        }
    }
}

#[test]
fn levels_match_the_exact_integral_in_every_layout() {
    let options = LoadOptions {
        builtin_size: [128, 64],
        ..LoadOptions::default()
    };
    for name in [
        "builtin:sky",
        "builtin:cap:elevation_deg=88,half_angle_deg=3,radiance=300",
    ] {
        let environment = Environment::load(name, Path::new("."), &options).unwrap();
        let exact = exact_quadrature(&environment.image);
        let tolerance = Tolerance {
            relative: 1e-5,
            max_part_count: 100_000,
        };
        let transform = harmonics(&environment.image, degree(0.03));
        for (model, weight, alpha) in [
            (0, 0, 0.03),
            (1, 1, 0.1),
            (2, 0, 0.0625),
            (0, 1, 1.0),
            (0, 0, 0.25),
        ] {
            let kernel = Kernel::new(MODELS[model], &WEIGHTS[weight], MaskingShadowing::Separable);
            for layout in LAYOUTS {
                let size = if layout.is_square { [24; 2] } else { [48, 24] };
                let texels = level(&transform, kernel, alpha, layout, size);
                // About thirty texels, the first one included.
                let extent = glam::DVec2::new(size[0].into(), size[1].into());
                let place = |i: usize| {
                    let (i, [width, height]) = (i as u32, size);
                    let at =
                        glam::DVec2::new((i % width).into(), (i / width % height).into()) + 0.5;
                    (layout.direction)(i / (width * height), at / extent)
                };
                let pairs = (0..texels.len())
                    .step_by(texels.len() / 31)
                    .map(|i| (place(i), texels[i]));
                let pairs: Vec<_> = pairs
                    .map(|(d, [r, g, b, _])| (d, glam::Vec3::new(r, g, b).as_dvec3()))
                    .collect();
                let found = relative_mse(&pairs, |d| {
                    prefilter(&exact, kernel, alpha, d, tolerance).value
                });
                let case = format!(
                    "{name} {} {} {} {alpha}",
                    layout.name,
                    MODELS[model].name(),
                    WEIGHTS[weight].name
                );
                assert!(found < 1e-9, "{case}: {found}");
            }
        }
        let smooth =
            harmonics(&environment.image, degree(1.0)).convolved(&cosine_factors(degree(1.0)));
        let pairs: Vec<_> = directions()
            .into_iter()
            .map(|d| (d, smooth.value(d)))
            .collect();
        let found = relative_mse(&pairs, |d| irradiance(&exact, d, tolerance).value / PI);
        assert!(found < 1e-9, "{name} irradiance: {found}");
    }
}

#[test]
fn turning_the_light_turns_its_levels() {
    let turn = DMat3::from_rotation_x(1.0) * DMat3::from_rotation_z(0.4);
    let light = |d: DVec3| (4.0 * d.dot(DVec3::new(0.6, 0.0, 0.8))).exp();
    let k = factors(Kernel::cosine(&Ggx), 0.3, 64);
    let [plain, turned] = [DMat3::IDENTITY, turn]
        .map(|by| harmonics(&map([512, 256], |d| light(by.transpose() * d)), 64).convolved(&k));
    let found: Vec<_> = directions()
        .into_iter()
        .map(|d| (d, turned.value(turn * d)))
        .collect();
    let off = relative_mse(&found, |d| plain.value(d));
    assert!(off < 1e-8, "{off}");
}

#[test]
fn the_transform_is_linear_and_a_sun_leaves_no_texel_below_the_sky() {
    let size = [256, 128];
    let mut image = map(size, |_| 0.5);
    image.data[40 * 256 + 7] = [1e5; 3];
    let sun = harmonics(&image, degree_of_map(0.0625));
    for alpha in [0.0625, 0.25, 1.0] {
        for layout in LAYOUTS {
            let side = if layout.is_square { [32; 2] } else { [64, 32] };
            let texels = level(&sun, Kernel::cosine(&Ggx), alpha, layout, side);
            let least = texels
                .iter()
                .map(|texel| texel[0])
                .fold(f32::INFINITY, f32::min);
            // The mean is 4.7: the rest of the edge at the horizon is below 1e-3 of it.
            assert!(least > 0.496, "{} {alpha}: {least}", layout.name);
        }
    }
    let mean = |image: &RgbImage| harmonics(image, 8).convolved(&[1.0, 0.0]).value(DVec3::X).x;
    // One texel of solid angle 2π²/(WH) sin θ.
    let omega = 2.0 * PI * PI / (256.0 * 128.0) * (PI * 40.5 / 128.0).sin();
    let expected = 0.5 + (1e5 - 0.5) * omega / (4.0 * PI);
    assert!(
        (mean(&image) / expected - 1.0).abs() < 1e-3,
        "{} for {expected}",
        mean(&image)
    );
    let both = Harmonics::new(256, 128, 8, |x, y| {
        image.data[y * 256 + x].map(|value| 2.0 * value)
    });
    assert!((both.convolved(&[1.0, 0.0]).value(DVec3::X).x / mean(&image) - 2.0).abs() < 1e-9);
}
