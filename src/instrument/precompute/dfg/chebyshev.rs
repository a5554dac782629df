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
const FIRST_COUNT: usize = 20;
/// Largest error of the polynomial at the positions where it is compared with an integral.
const MAX_ERROR: f64 = 5e-5;
/// The polynomial is compared between every fourth pair of points.
const CHECK_STEP: usize = 4;
/// Scale of the axis of roughness.
const ROUGHNESS_SCALE: f64 = 0.1;

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

/// The texels of a table, n·v along x and perceptual roughness along y, and the axes between its
/// outermost texels.
struct Domain {
    side: u32,
    /// The device shades no narrower lobe.
    least_roughness: f64,
    /// n·v of the first and the last column.
    n_dot_v_ends: [f64; 2],
    roughness_axis: Axis,
}

impl Domain {
    fn new(side: u32) -> Self {
        let least_roughness = perceptual_roughness_from_alpha(ALPHA_MIN.into());
        let ends = [0, side - 1].map(|index| texel_centre(index, side));
        let roughness_ends = ends.map(|end| end.max(least_roughness));
        Self {
            side,
            least_roughness,
            n_dot_v_ends: ends,
            roughness_axis: Axis::new(roughness_ends, ROUGHNESS_SCALE),
        }
    }

    fn n_dot_v(&self, x: u32) -> f64 {
        texel_centre(x, self.side)
    }

    fn roughness(&self, y: u32) -> f64 {
        texel_centre(y, self.side).max(self.least_roughness)
    }

    /// Returns the axis of n·v at a roughness.
    fn n_dot_v_axis(&self, roughness: f64) -> Axis {
        let alpha = alpha_from_perceptual_roughness(roughness);
        Axis::new(self.n_dot_v_ends, alpha / (1.0 + 5.0 * alpha))
    }

    /// Returns n·v and roughness at a point of the unit square.
    fn parameters(&self, u: f64, v: f64) -> DVec2 {
        let roughness = self.roughness_axis.x(v);
        DVec2::new(self.n_dot_v_axis(roughness).x(u), roughness)
    }

    /// Integrates every texel.
    fn integrated(&self, pair: &(impl Fn(DVec2) -> DVec2 + Sync)) -> Vec<DVec2> {
        (0..self.side * self.side)
            .into_par_iter()
            .map(|i| {
                pair(DVec2::new(
                    self.n_dot_v(i % self.side),
                    self.roughness(i / self.side),
                ))
            })
            .collect()
    }
}

/// Returns the centre of a texel, in units of the table's side.
fn texel_centre(index: u32, side: u32) -> f64 {
    (f64::from(index) + 0.5) / f64::from(side)
}

/// Returns the Chebyshev point with that number of `count` on [0, 1]; halves lie between points.
fn chebyshev_point(number: f64, count: usize) -> f64 {
    0.5 - 0.5 * (PI * number / (count - 1) as f64).cos()
}

/// The polynomial through the integrals at the Chebyshev points of both axes.
struct Fit<'a> {
    domain: &'a Domain,
    /// Points of each axis, in [0, 1].
    points: Vec<f64>,
    /// A and B at the points: rows of equal roughness.
    values: Vec<DVec2>,
}

impl<'a> Fit<'a> {
    /// Integrates A and B at `count` x `count` points.
    fn new(domain: &'a Domain, count: usize, pair: &(impl Fn(DVec2) -> DVec2 + Sync)) -> Self {
        let points: Vec<f64> = (0..count)
            .map(|i| chebyshev_point(i as f64, count))
            .collect();
        let values = (0..count * count)
            .into_par_iter()
            .map(|i| pair(domain.parameters(points[i % count], points[i / count])))
            .collect();
        Self {
            domain,
            points,
            values,
        }
    }

    /// Returns the polynomial's values at the points of n·v, for one position on the axis of
    /// roughness.
    fn row(&self, v: f64) -> Vec<DVec2> {
        let count = self.points.len();
        (0..count)
            .map(|i| interpolated(&self.points, v, |j| self.values[j * count + i]))
            .collect()
    }

    /// Whether the polynomial agrees with integrals between its points.
    fn is_close(&self, pair: &(impl Fn(DVec2) -> DVec2 + Sync)) -> bool {
        let count = self.points.len();
        let checks: Vec<f64> = (0..count - 1)
            .step_by(CHECK_STEP)
            .map(|i| chebyshev_point(i as f64 + 0.5, count))
            .collect();
        checks.par_iter().all(|&v| {
            let row = self.row(v);
            checks.iter().all(|&u| {
                let exact = pair(self.domain.parameters(u, v));
                let error = interpolated(&self.points, u, |i| row[i]) - exact;
                error.abs().max_element() <= MAX_ERROR
            })
        })
    }

    /// Evaluates the polynomial at a row of texels.
    fn texel_row(&self, y: u32) -> Vec<DVec2> {
        let roughness = self.domain.roughness(y);
        let row = self.row(self.domain.roughness_axis.unit(roughness));
        let axis = self.domain.n_dot_v_axis(roughness);
        (0..self.domain.side)
            .map(|x| {
                let u = axis.unit(self.domain.n_dot_v(x));
                interpolated(&self.points, u, |i| row[i])
            })
            .collect()
    }

    fn texels(&self) -> Vec<DVec2> {
        (0..self.domain.side)
            .into_par_iter()
            .flat_map_iter(|y| self.texel_row(y))
            .collect()
    }
}

/// Makes the table of `side` x `side` texel centres, n·v along x and perceptual roughness along y,
/// no narrower than the device shades. `pair` integrates A and B at both; a polynomial adds at most
/// 1e-4 to its error.
pub fn table(side: u32, pair: impl Fn(DVec2) -> DVec2 + Sync) -> Pixels<DVec2> {
    let domain = Domain::new(side);
    let mut count = FIRST_COUNT;
    // With as many points as texels the integrals of the texels are cheaper.
    while count < side as usize {
        let fit = Fit::new(&domain, count, &pair);
        if fit.is_close(&pair) {
            return Pixels::new(side, side, fit.texels());
        }
        count *= 2;
    }
    Pixels::new(side, side, domain.integrated(&pair))
}

/// Returns the value at `x` of the polynomial through Chebyshev points, by the barycentric formula
/// [chapter 5].
fn interpolated(points: &[f64], x: f64, value: impl Fn(usize) -> DVec2) -> DVec2 {
    let mut weighted_sum = DVec2::ZERO;
    let mut weight_sum = 0.0;
    for (i, point) in points.iter().enumerate() {
        if (x - point).abs() < 1e-14 {
            return value(i);
        }
        let is_end = i == 0 || i == points.len() - 1;
        let size = if is_end { 0.5 } else { 1.0 };
        let signed = if i.is_multiple_of(2) { size } else { -size };
        let weight = signed / (x - point);
        weighted_sum += weight * value(i);
        weight_sum += weight;
    }
    weighted_sum / weight_sum
}
