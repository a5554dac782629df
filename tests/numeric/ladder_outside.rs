//! The ladder's integrals against sums over a latitude-longitude grid, written from the formulas
//! alone. They use no frame, BRDF or lookup of the program, and their kernels are functions of
//! cosines, without half vectors.

use fastrand::Rng;
use glam::DVec3;
use rayon::prelude::*;
use splitsum::base::names::Listed;
use splitsum::base::pixels::RgbImage;
use splitsum::instrument::brdf::Brdf;
use splitsum::instrument::brdf::MaskingShadowing;
use splitsum::instrument::precompute::dfg::reference::dfg;
use splitsum::instrument::precompute::prefilter::Kernel;
use splitsum::instrument::precompute::prefilter::reference::prefilter;
use splitsum::instrument::precompute::{PrecomputeSettings, exact_quadrature};
use splitsum::instrument::shade::reference::{Surface, TOLERANCE};
use splitsum::instrument::shade::twin::Twin;
use splitsum::instrument::shade::{EXACT_SPLIT, Method, REFERENCE};
use std::f64::consts::{PI, TAU};

const SIZE: [usize; 2] = [64, 32];
const QUERIES: u64 = 60;

/// The k-th of a sequence of pseudo-random numbers in [0, 1).
fn random(k: u64) -> f64 {
    Rng::with_seed(k.wrapping_mul(0x9e37_79b9_7f4a_7c15)).f64()
}

/// Rough light with a lamp 40 times as bright, and light at both poles.
fn light(x: u32, y: u32) -> [f32; 3] {
    let is_lamp = (40..43).contains(&x) && (9..11).contains(&y);
    let base = if is_lamp { 40.0 } else { 1.0 };
    std::array::from_fn(|channel| {
        (base * (0.2 + random(u64::from((x * 64 + y) * 3) + channel as u64))) as f32
    })
}

/// A direction, its radiance, and its solid angle in sr.
struct Node {
    l: DVec3,
    radiance: DVec3,
    share: f64,
}

/// Two nodes per side in each of `parts` x `parts` parts of every cell between four texel centres,
/// because light is smooth in each.
fn grid(map: impl Fn(usize, usize) -> DVec3, parts: usize) -> Vec<Node> {
    let [width, height] = SIZE;
    let offset = 0.5 / 3f64.sqrt();
    let places: Vec<f64> = (0..parts)
        .flat_map(|i| [-offset, offset].map(|o| (i as f64 + 0.5 + o) / parts as f64))
        .collect();
    let mut nodes = Vec::new();
    for band in 0..=height {
        // Rows of texels clamp at the poles, where a band is half as high.
        let rows = [band.max(1) - 1, band.min(height - 1)];
        let ends = [
            (band as f64 - 0.5).max(0.0),
            (band as f64 + 0.5).min(height as f64),
        ];
        for column in 0..width {
            for y in &places {
                let row = ends[0] + (ends[1] - ends[0]) * y;
                let theta = PI * row / height as f64;
                let down = row - (band as f64 - 0.5);
                for x in &places {
                    let phi = TAU * (0.5 - (column as f64 + 0.5 + x) / width as f64);
                    let of_row = |row: usize| {
                        map(column, row) * (1.0 - x) + map((column + 1) % width, row) * *x
                    };
                    let cell = PI * (ends[1] - ends[0]) / height as f64 * TAU / width as f64;
                    nodes.push(Node {
                        l: DVec3::new(
                            phi.sin() * theta.sin(),
                            theta.cos(),
                            phi.cos() * theta.sin(),
                        ),
                        radiance: of_row(rows[0]) * (1.0 - down) + of_row(rows[1]) * down,
                        share: cell * theta.sin() / (places.len() * places.len()) as f64,
                    });
                }
            }
        }
    }
    nodes
}

fn d(model: &str, alpha: f64, n_dot_h2: f64) -> f64 {
    let (a2, tan2) = (alpha * alpha, 1.0 / n_dot_h2 - 1.0);
    match model {
        "ggx" => a2 / (PI * n_dot_h2 * n_dot_h2 * (a2 + tan2).powi(2)),
        "beckmann" => (-tan2 / a2).exp() / (PI * a2 * n_dot_h2 * n_dot_h2),
        _ => n_dot_h2.powf(1.0 / a2 - 1.0) / (PI * a2),
    }
}

fn g1(model: &str, alpha: f64, cosine: f64) -> f64 {
    let tan2 = 1.0 / (cosine * cosine) - 1.0;
    let a = 1.0 / (alpha * tan2.sqrt());
    match model {
        "ggx" => 2.0 / (1.0 + (1.0 + alpha * alpha * tan2).sqrt()),
        _ if a < 1.6 => (3.535 * a + 2.181 * a * a) / (1.0 + 2.276 * a + 2.577 * a * a),
        _ => 1.0,
    }
}

struct Query {
    model: &'static str,
    alpha: f64,
    f0: DVec3,
    n: DVec3,
    v: DVec3,
}

fn query(k: u64) -> Query {
    let of = |i: u64| random(1_000_000 + 16 * k + i);
    let direction = |i: u64| {
        let (y, phi) = (2.0 * of(i) - 1.0, TAU * of(i + 1));
        DVec3::new(
            (1.0 - y * y).sqrt() * phi.cos(),
            y,
            (1.0 - y * y).sqrt() * phi.sin(),
        )
    };
    let (n, other) = (direction(0), direction(2));
    let across = (other - n * n.dot(other)).normalize();
    let n_dot_v = 0.05 + 0.95 * of(4);
    Query {
        model: ["ggx", "beckmann", "phong"][k as usize % 3],
        // Logarithmic: narrow lobes as often as wide ones.
        alpha: 0.15f64.powf(of(5)),
        f0: DVec3::new(of(6), of(7), of(8)),
        n,
        v: n * n_dot_v + across * (1.0 - n_dot_v * n_dot_v).sqrt(),
    }
}

impl Query {
    fn surface(&self) -> Surface {
        let Self {
            alpha, f0, n, v, ..
        } = *self;
        Surface::new(
            <dyn Brdf>::listed(self.model),
            MaskingShadowing::Separable,
            alpha,
            f0,
            [n, v],
        )
    }

    /// The specular integral, the split sum with exact factors, and the specular integral under
    /// light of 1.
    fn sums(&self, nodes: &[Node]) -> [DVec3; 3] {
        let Self {
            model,
            alpha,
            f0,
            n,
            v,
        } = *self;
        let (n_dot_v, r) = (n.dot(v), 2.0 * n.dot(v) * n - v);
        let (mut specular, mut furnace, mut blurred, mut whole) =
            (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, 0.0);
        for Node { l, radiance, share } in nodes {
            let (n_dot_l, r_dot_l) = (n.dot(*l), r.dot(*l));
            if n_dot_l > 0.0 {
                // h = (v + l) / |v + l|, and |v + l|² = 2 (1 + v·l).
                let cosine = v.dot(*l);
                let n_dot_h2 = (n_dot_v + n_dot_l).powi(2) / (2.0 * (1.0 + cosine));
                let fresnel = f0 + (1.0 - f0) * (1.0 - (0.5 * (1.0 + cosine)).sqrt()).powi(5);
                let g2 = g1(model, alpha, n_dot_v) * g1(model, alpha, n_dot_l);
                let kernel = share * d(model, alpha, n_dot_h2) * g2 / (4.0 * n_dot_v) * fresnel;
                specular += kernel * *radiance;
                furnace += kernel;
            }
            if r_dot_l > 0.0 {
                let kernel = share * d(model, alpha, 0.5 * (1.0 + r_dot_l)) * r_dot_l;
                blurred += kernel * *radiance;
                whole += kernel;
            }
        }
        // f0 A + B is the reflected part of light of 1.
        [specular, furnace * blurred / whole, furnace]
    }
}

#[test]
fn rungs_are_sums_over_latitude_and_longitude() {
    let [width, height] = SIZE.map(|side| side as u32);
    let image = RgbImage::from_fn(width, height, light);
    let exact = exact_quadrature(&image);
    let map = |x: usize, y: usize| DVec3::from_array(light(x as u32, y as u32).map(f64::from));
    let grids = [2, 4, 8].map(|parts| grid(map, parts));
    let settings = PrecomputeSettings::default();
    // A fault, or the sums' own error.
    let judged = (0..QUERIES).into_par_iter().map(|k| {
        let query = query(k);
        let (surface, [coarse, half, full]) = (
            query.surface(),
            grids.each_ref().map(|nodes| query.sums(nodes)),
        );
        let rung = |name: &str| {
            let Twin::Mean(twin) = Method::listed(name).twin else {
                panic!("{name} is not an integral")
            };
            twin(&exact, &surface, &settings, TOLERANCE)
        };
        // The two factors of the split sum, each by its own stage.
        let r = 2.0 * query.n.dot(query.v) * query.n - query.v;
        let blurred = prefilter(
            &exact,
            Kernel::cosine(surface.model),
            query.alpha,
            r,
            TOLERANCE,
        );
        let pair = dfg(
            surface.model,
            surface.masking,
            query.n.dot(query.v),
            query.alpha,
        );
        let reflected = query.f0 * pair.f0_scale + pair.f90_scale;
        let of_pair = blurred.value * pair.error;
        let split = (
            blurred.value * reflected,
            blurred.error * reflected + of_pair,
        );
        let [reference, view] = [REFERENCE, EXACT_SPLIT].map(rung);
        let found = [
            ("reference", (reference.value, reference.error), 0),
            ("ladder-view", (view.value, view.error + of_pair), 1),
            ("split sum", split, 1),
            ("furnace", (reflected, DVec3::splat(pair.error)), 2),
        ];
        let place = format!(
            "query {k}, {} alpha {:.3} n·v {:.3}",
            query.model,
            query.alpha,
            query.n.dot(query.v)
        );
        let mut worst = 0f64;
        for (name, (value, bound), which) in found {
            // Two doublings: if one changes little by chance, the other does not.
            let own =
                (full[which] - half[which]).abs() + 0.25 * (half[which] - coarse[which]).abs();
            let error = (value - full[which]).abs();
            worst = worst.max((own / full[which]).max_element());
            if !error.cmple(bound + own).all() {
                return Err(format!(
                    "{place}: {name} {value}, not {}: bound {bound}, own {own}",
                    full[which]
                ));
            }
        }
        Ok(worst)
    });
    let judged: Vec<Result<f64, String>> = judged.collect();
    let faults: Vec<&String> = judged.iter().filter_map(|one| one.as_ref().err()).collect();
    assert!(faults.is_empty(), "{faults:#?}");
    // The sums are fine enough to detect a difference.
    let mut own: Vec<f64> = judged.into_iter().flatten().collect();
    own.sort_by(f64::total_cmp);
    let (middle, worst) = (own[own.len() / 2], own[own.len() - 1]);
    assert!(middle < 1e-5 && worst < 1e-3, "{middle:e} {worst:e}");
}
