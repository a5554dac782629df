//! Computes texels from radiance formulas.

use crate::base::math::equirect;
use crate::base::pixels::RgbImage;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Latitudes per row over which a cap's coverage is integrated; the midpoint error of the energy is
/// below 1e-5.
const CAP_LATITUDES: u32 = 256;

/// Returns the unit direction of an azimuth (from +z towards +x) and an elevation above the
/// horizon, radians.
pub fn direction(azimuth: f64, elevation: f64) -> DVec3 {
    let (sin, cos) = azimuth.sin_cos();
    DVec3::new(
        sin * elevation.cos(),
        elevation.sin(),
        cos * elevation.cos(),
    )
}

/// Evaluates a smooth formula at texel centres, where the bilinear lookup returns it exactly.
pub fn at_centers(size: [u32; 2], radiance: impl Fn(DVec3) -> DVec3 + Sync) -> RgbImage {
    let height = f64::from(size[1]);
    by_texel(
        size,
        1,
        |y, offset| (f64::from(y) + offset) / height,
        |_, d| radiance(d),
    )
}

/// Averages a formula of (u, v) and direction, with edges, over each texel: `n` x `n` samples of
/// equal solid angle.
pub fn supersampled(
    size: [u32; 2],
    n: u32,
    radiance: impl Fn(DVec2, DVec3) -> DVec3 + Sync,
) -> RgbImage {
    let cos_theta = |row: u32| (PI * f64::from(row) / f64::from(size[1])).cos();
    let v = |y: u32, offset: f64| {
        let top = cos_theta(y);
        let bottom = cos_theta(y + 1);
        // Equal steps of cos θ are equal solid angles.
        (top + (bottom - top) * offset).clamp(-1.0, 1.0).acos() / PI
    };
    by_texel(size, n, v, radiance)
}

/// Averages `n` x `n` samples per texel; `v` maps a row and an offset in it. One sine and cosine
/// per row and column.
fn by_texel(
    [width, height]: [u32; 2],
    n: u32,
    v: impl Fn(u32, f64) -> f64 + Sync,
    radiance: impl Fn(DVec2, DVec3) -> DVec3 + Sync,
) -> RgbImage {
    let offset = |i: u32| (f64::from(i) + 0.5) / f64::from(n);
    let u = (0..width * n).map(|i| (f64::from(i / n) + offset(i % n)) / f64::from(width));
    let columns: Vec<_> = u.map(|u| (u, equirect::longitude(u))).collect();
    let mut image = RgbImage::filled(width, height, [0.0; 3]);
    image
        .data
        .par_chunks_mut(width as usize)
        .zip(0..height)
        .for_each(|(texels, y)| {
            let v = (0..n).map(|i| v(y, offset(i)));
            let rows: Vec<_> = v.map(|v| (v, equirect::polar_angle(v))).collect();
            for (texel, columns) in texels.iter_mut().zip(columns.chunks_exact(n as usize)) {
                let mut sum = DVec3::ZERO;
                for &(v, polar_angle) in &rows {
                    for &(u, longitude) in columns {
                        sum += radiance(
                            DVec2::new(u, v),
                            equirect::direction_from_angles(longitude, polar_angle),
                        );
                    }
                }
                *texel = (sum / f64::from(n * n)).as_vec3().to_array();
            }
        });
    image
}

/// Calls `cover(texel index, share of its solid angle in the cap)` for every texel that touches the
/// cap about `center`.
///
/// On the latitude θ the cap spans `|φ - φc| <= acos((cos a - cos θ cos θc) / (sin θ sin θc))`
/// exactly. Only θ is integrated numerically, over `θ = θc + a sin t`, which removes the square
/// roots at the ends of the span. So the energy of a disc far smaller than a texel is as accurate
/// as a large one's.
pub fn cover_cap(
    [width, height]: [u32; 2],
    center: DVec3,
    half_angle: f64,
    mut cover: impl FnMut(usize, f64),
) {
    let columns = f64::from(width);
    let rows = f64::from(height);
    let theta_center = center.x.hypot(center.z).atan2(center.y);
    let u_center = equirect::uv_from_direction(center).x;
    let in_cap = |theta: f64| {
        ((theta - theta_center) / half_angle)
            .clamp(-1.0, 1.0)
            .asin()
    };
    let mut spans = vec![0.0; width as usize];
    for y in 0..height {
        let top = PI * f64::from(y) / rows;
        let bottom = PI * f64::from(y + 1) / rows;
        let t0 = in_cap(top);
        let t1 = in_cap(bottom);
        if t0 >= FRAC_PI_2 || t1 <= -FRAC_PI_2 {
            continue;
        }
        spans.fill(0.0);
        let step = (t1 - t0) / f64::from(CAP_LATITUDES);
        let mut measure = 0.0;
        for i in 0..CAP_LATITUDES {
            let t = t0 + (f64::from(i) + 0.5) * step;
            let theta = theta_center + half_angle * t.sin();
            let weight = half_angle * t.cos() * theta.sin() * step;
            measure += weight;
            let cos_span = (half_angle.cos() - theta.cos() * theta_center.cos())
                / (theta.sin() * theta_center.sin());
            // Over a pole the quotient leaves [-1, 1] or is ±∞: the whole latitude is inside or
            // outside.
            let half_span_u = cos_span.clamp(-1.0, 1.0).acos() / TAU;
            add_span(
                &mut spans,
                (u_center - half_span_u) * columns,
                (u_center + half_span_u) * columns,
                weight,
            );
        }
        // The row's part within the cap's latitudes is known exactly; this corrects the midpoint
        // error inside.
        let exact =
            top.max(theta_center - half_angle).cos() - bottom.min(theta_center + half_angle).cos();
        let row = top.cos() - bottom.cos();
        for (x, &span) in spans.iter().enumerate().filter(|(_, span)| **span > 0.0) {
            cover(
                y as usize * width as usize + x,
                (span * exact / (measure * row)).min(1.0),
            );
        }
    }
}

/// Adds `weight` times the covered share to each column of `[from, to]`, in columns; the row wraps.
fn add_span(spans: &mut [f64], from: f64, to: f64, weight: f64) {
    let columns = spans.len() as i64;
    for column in from.floor() as i64..to.ceil() as i64 {
        let overlap = (to.min((column + 1) as f64) - from.max(column as f64)).max(0.0);
        spans[column.rem_euclid(columns) as usize] += weight * overlap;
    }
}
