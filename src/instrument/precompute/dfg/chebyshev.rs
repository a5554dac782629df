//! A table of A and B from few integrals: a polynomial through Chebyshev points [Trefethen,
//! Approximation Theory and Approximation Practice, 2013, chapters 2 and 5].
//!
//! A and B change most where n·v is about alpha; under wide lobes the correlated masking also bends
//! at smaller n·v. So the axes are `asinh(n·v / s)`, `s = alpha/(1 + 5 alpha)`, and `asinh(10
//! roughness)`, where both are smooth.

use crate::base::glsl::constants::ALPHA_MIN;
use crate::base::pixels::Pixels;
use crate::instrument::brdf::{alpha_from_perceptual_roughness, perceptual_roughness_from_alpha};
use glam::DVec2;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Points along each axis at first, enough for GGX; Beckmann and Phong need twice as many.
const COUNT: usize = 20;
/// Largest error of the polynomial where it is compared with an integral: between every fourth pair
/// of points.
const WITHIN: f64 = 5e-5;
const COMPARED: usize = 4;

/// Maps x from one end to the other to [0, 1], evenly in `asinh(x / scale)`.
struct Axis {
    scale: f64,
    ends: [f64; 2],
}

impl Axis {
    fn new(ends: [f64; 2], scale: f64) -> Self {
        Self {
            scale,
            ends: ends.map(|end| (end / scale).asinh()),
        }
    }

    fn unit(&self, x: f64) -> f64 {
        ((x / self.scale).asinh() - self.ends[0]) / (self.ends[1] - self.ends[0])
    }

    /// Inverse of [`Self::unit`].
    fn x(&self, unit: f64) -> f64 {
        self.scale * (self.ends[0] + (self.ends[1] - self.ends[0]) * unit).sinh()
    }
}

/// Makes the table of `side` x `side` texel centres, n·v along x and perceptual roughness along y,
/// no narrower than the device shades. `pair` integrates A and B at both; a polynomial adds at most
/// 1e-4 to its error.
pub fn table(side: u32, pair: impl Fn(DVec2) -> DVec2 + Sync) -> Pixels<DVec2> {
    let narrowest = perceptual_roughness_from_alpha(ALPHA_MIN.into());
    let place = |at: u32| (f64::from(at) + 0.5) / f64::from(side);
    let roughness = |y: u32| place(y).max(narrowest);
    let ends = [0, side - 1].map(place);
    let rows = Axis::new(ends.map(|end| end.max(narrowest)), 0.1);
    let columns = |roughness: f64| {
        let alpha = alpha_from_perceptual_roughness(roughness);
        Axis::new(ends, alpha / (1.0 + 5.0 * alpha))
    };
    // With as many points as texels the integrals of the texels are cheaper.
    let counts = std::iter::successors(Some(COUNT), |count| Some(2 * count))
        .take_while(|count| *count < side as usize);
    let texel = |count: usize| -> Option<Vec<DVec2>> {
        let unit = |i: f64| 0.5 - 0.5 * (PI * i / (count - 1) as f64).cos();
        let points: Vec<f64> = (0..count).map(|i| unit(i as f64)).collect();
        let exact = |[u, v]: [f64; 2]| pair(DVec2::new(columns(rows.x(v)).x(u), rows.x(v)));
        let values: Vec<DVec2> = (0..count * count)
            .into_par_iter()
            .map(|i| exact([points[i % count], points[i / count]]))
            .collect();
        let line = |v| {
            (0..count)
                .map(|i| interpolated(&points, v, |j| values[j * count + i]))
                .collect::<Vec<_>>()
        };
        let checks: Vec<f64> = (0..count - 1)
            .step_by(COMPARED)
            .map(|i| unit(i as f64 + 0.5))
            .collect();
        let is_close = |v: &f64| {
            let line = line(*v);
            let off = |u: f64| {
                (interpolated(&points, u, |i| line[i]) - exact([u, *v]))
                    .abs()
                    .max_element()
            };
            checks.iter().all(|u| off(*u) <= WITHIN)
        };
        let of_row = |y: u32| {
            let (line, axis, points) = (
                line(rows.unit(roughness(y))),
                columns(roughness(y)),
                &points,
            );
            (0..side).map(move |x| interpolated(points, axis.unit(place(x)), |i| line[i]))
        };
        checks
            .par_iter()
            .all(is_close)
            .then(|| (0..side).into_par_iter().flat_map_iter(of_row).collect())
    };
    let exact = || {
        (0..side * side)
            .into_par_iter()
            .map(|i| pair(DVec2::new(place(i % side), roughness(i / side))))
    };
    Pixels::new(
        side,
        side,
        counts
            .map(texel)
            .find_map(|found| found)
            .unwrap_or_else(|| exact().collect()),
    )
}

/// Returns the value at `x` of the polynomial through Chebyshev points, by the barycentric formula
/// [chapter 5].
fn interpolated(points: &[f64], x: f64, value: impl Fn(usize) -> DVec2) -> DVec2 {
    let (mut sum, mut whole) = (DVec2::ZERO, 0.0);
    for (i, point) in points.iter().enumerate() {
        if (x - point).abs() < 1e-14 {
            return value(i);
        }
        let end = if i == 0 || i == points.len() - 1 {
            0.5
        } else {
            1.0
        };
        let weight = (if i.is_multiple_of(2) { end } else { -end }) / (x - point);
        (sum, whole) = (sum + weight * value(i), whole + weight);
    }
    sum / whole
}
