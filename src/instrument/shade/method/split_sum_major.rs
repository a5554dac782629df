//! Split sums of an anisotropic lobe by equal lookups along the major axis of what it reflects
//! \[Cocco24\], read from the authors' program (iota97/AnisotropyEditor, `fast.frag`, commit
//! 6635177), with our table of albedos.
//!
//! The slopes `p(a) = (alpha_x cos a, alpha_y sin a) / √2` are an ellipse of normals. The major
//! axis has the largest `|r(p) - r(-p)|² (1 + |p|²)`, the minor axis the least, where r(p) is the
//! mirror direction about (p, 1).

use super::Method;
use super::split_sum::several;
use crate::base::glsl::constants::{ALPHA_MIN, MAJOR_SPACING};
use crate::instrument::brdf::{Widths, reflect};
use crate::instrument::shade::reference::Surface;
use crate::instrument::shade::twin::{Light, Twin};
use glam::{DVec2, DVec3, Vec2Swizzles};
use std::f64::consts::FRAC_1_SQRT_2;

pub const TWO: Method = several(
    2,
    "split-sum-major-two",
    "Split sum (two on the major axis)",
    "an anisotropic lobe by two equal lookups along its major axis",
    Twin::Estimator(|surface, light, _| split_sum(surface, light, 2)),
);

pub const FOUR: Method = several(
    4,
    "split-sum-major-four",
    "Split sum (four on the major axis)",
    "an anisotropic lobe by four equal lookups along its major axis",
    Twin::Estimator(|surface, light, _| split_sum(surface, light, 4)),
);

/// Computes the mean of `P(l, alpha)` over the lookups, times `f0 A + B`.
fn split_sum(surface: &Surface, light: &Light, count: u32) -> DVec3 {
    let Widths(widths) = surface.widths();
    let frame = surface.frame();
    let v = frame.to_local(surface.v);
    let radii = FRAC_1_SQRT_2 * widths;
    let scale = (DVec2::ONE + radii * radii).map(f64::sqrt).recip();
    let stretched = radii * scale;
    let squares = stretched * stretched * (DVec2::ONE - (v * v).truncate().yx());
    let turn = (2.0 * stretched.x * stretched.y * v.x * v.y).atan2(squares.x - squares.y) / 2.0;
    let axis = DVec2::from_angle(turn);
    let [mut major, minor] = [axis, axis.perp()].map(|axis| (scale * axis).normalize());
    if (radii * major).dot(v.truncate()) < 0.0 {
        major = -major;
    }
    let normal = |slope: DVec2| slope.extend(1.0).normalize();
    // Towards v every normal reflects above the horizon; away from it, those up to `end`.
    let slope = radii * major;
    let along = slope.dot(v.truncate());
    let end =
        (-v.z / (along + (along * along + v.z * v.z * slope.length_squared()).sqrt())).max(-1.0);
    let ends = [end, 1.0].map(|share| normal(share * slope));
    // What the horizon cuts off moves the minor axis as well.
    let moved = 0.5 * (1.0 + end) * major.dot(minor).abs().min(1.0).acos();
    let aside = minor.perp() * minor.perp().dot(major).signum();
    let sides =
        [1.0, -1.0].map(|side| normal(radii * (side * moved.cos() * minor + moved.sin() * aside)));
    let [long, short] = [ends, sides].map(|[a, b]| reflect(v, a).distance(reflect(v, b)));
    let centre = (ends[0] + ends[1]).normalize();
    let [from, to] = ends.map(|end| centre.lerp(end, 1.0 - short / long).normalize());
    let alpha = (0.5 * short.max(f64::from(MAJOR_SPACING) * long / f64::from(count)))
        .clamp(ALPHA_MIN.into(), 1.0);
    let lookup = |i: u32| {
        let normal = from
            .lerp(to, f64::from(i) / f64::from(count - 1))
            .normalize();
        light.mean_radiance(frame.to_world(reflect(v, normal).normalize()), alpha)
    };
    let pair = light.dfg(v.z, surface.alpha);
    (0..count).map(lookup).sum::<DVec3>() / f64::from(count) * (surface.f0 * pair.x + pair.y)
}
