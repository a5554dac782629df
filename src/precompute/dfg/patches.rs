//! A table of A and B from few integrals: polynomials on patches, as large as the error allows.
//!
//! Over `(√n·v, roughness)` A and B are analytic away from the corner of small values, so a polynomial through Chebyshev
//! points converges fast [Trefethen, Approximation Theory and Approximation Practice, 2013, chapters 2 and 5].

use crate::pixels::Pixels;
use glam::DVec2;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Points along each side of a patch.
const COUNT: usize = 12;
/// Largest error of a polynomial at the texels at which it is compared with its integral.
const WITHIN: f64 = 2e-5;

/// A half-open range of texels.
#[derive(Clone, Copy)]
struct Patch {
    low: [u32; 2],
    high: [u32; 2],
}

/// Makes the table of `side` x `side` texel centres, n·v along x and perceptual roughness along y. `pair` integrates A
/// and B at both; polynomials add at most [`WITHIN`] to its error.
pub fn table(side: u32, pair: impl Fn(DVec2) -> DVec2 + Sync) -> Pixels<DVec2> {
    let mut table = Pixels::filled(side, side, DVec2::ZERO);
    for ([x, y], value) in texels(side, Patch { low: [0; 2], high: [side; 2] }, &pair) {
        table.data[(y * side + x) as usize] = value;
    }
    table
}

fn texels(side: u32, patch: Patch, pair: &(impl Fn(DVec2) -> DVec2 + Sync)) -> Vec<([u32; 2], DVec2)> {
    let [width, height] = [0, 1].map(|i| patch.high[i] - patch.low[i]);
    let place = |at: u32| (f64::from(at) + 0.5) / f64::from(side);
    let all: Vec<[u32; 2]> =
        (0..width * height).map(|i| [patch.low[0] + i % width, patch.low[1] + i / width]).collect();
    let exact = |[x, y]: [u32; 2]| pair(DVec2::new(place(x), place(y)));
    if all.len() <= COUNT * COUNT {
        return all.into_par_iter().map(|at| (at, exact(at))).collect();
    }
    let middle = [patch.low[0] + width / 2, patch.low[1] + height / 2];
    let quarter = |i: usize| {
        let of = |axis: usize| match i >> axis & 1 {
            0 => [patch.low[axis], middle[axis]],
            _ => [middle[axis], patch.high[axis]],
        };
        let ([x0, x1], [y0, y1]) = (of(0), of(1));
        texels(side, Patch { low: [x0, y0], high: [x1, y1] }, pair)
    };
    let divided = || (0..4).into_par_iter().flat_map(quarter).collect();
    // No polynomial is close at the corner.
    if patch.low == [0; 2] {
        return divided();
    }
    // The sides of the patch: √n·v and roughness.
    let [u, v] = [0, 1].map(|i| {
        let ends = [patch.low[i], patch.high[i] - 1].map(place);
        points(if i == 0 { ends.map(f64::sqrt) } else { ends })
    });
    let values: Vec<DVec2> =
        (0..COUNT * COUNT).into_par_iter().map(|i| pair(DVec2::new(u[i % COUNT].powi(2), v[i / COUNT]))).collect();
    let columns: Vec<_> = (patch.low[0]..patch.high[0]).map(|x| weights(&u, place(x).sqrt())).collect();
    let rows: Vec<_> = (patch.low[1]..patch.high[1]).map(|y| weights(&v, place(y))).collect();
    let value = |[x, y]: [u32; 2]| -> DVec2 {
        let (column, row) = (&columns[(x - patch.low[0]) as usize], &rows[(y - patch.low[1]) as usize]);
        (0..COUNT * COUNT).map(|i| column[i % COUNT] * row[i / COUNT] * values[i]).sum()
    };
    let compared =
        [1, 4, 8, 11].map(|y| [1, 4, 8, 11].map(|x| [patch.low[0] + width * x / 12, patch.low[1] + height * y / 12]));
    let is_close = |at: &[u32; 2]| (value(*at) - exact(*at)).abs().max_element() <= WITHIN;
    if compared.as_flattened().par_iter().all(is_close) {
        return all.into_iter().map(|at| (at, value(at))).collect();
    }
    divided()
}

/// Chebyshev points from one end to the other.
fn points([low, high]: [f64; 2]) -> [f64; COUNT] {
    std::array::from_fn(|i| 0.5 * (low + high) - 0.5 * (high - low) * (PI * i as f64 / (COUNT - 1) as f64).cos())
}

/// Weights of the values at `points` in the polynomial's value at `x`, by the barycentric formula [chapter 5].
fn weights(points: &[f64; COUNT], x: f64) -> [f64; COUNT] {
    if let Some(found) = points.iter().position(|point| (point - x).abs() < 1e-14) {
        return std::array::from_fn(|i| f64::from(u8::from(i == found)));
    }
    let term = |i: usize| {
        let end = if i == 0 || i == COUNT - 1 { 0.5 } else { 1.0 };
        (if i.is_multiple_of(2) { end } else { -end }) / (x - points[i])
    };
    let sum: f64 = (0..COUNT).map(term).sum();
    std::array::from_fn(|i| term(i) / sum)
}
