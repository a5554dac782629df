//! The split sum of an anisotropic lobe about a bent normal, by the axis `bend`
//! ([`crate::instrument::shade::bend`]).

use super::Method;
use super::split_sum::shifted;
use super::split_sum_engines::share_of_r;
use crate::instrument::brdf::{Widths, reflect};
use crate::instrument::shade::bend::{Bend, DfgWidth, Normal, Parameters, Toward};
use crate::instrument::shade::reference::Surface;
use crate::instrument::shade::twin::{Light, Twin};
use glam::DVec3;

pub const METHOD: Method = Method {
    uses_bend: true,
    ..shifted(
        "split-sum-bent",
        "Split sum (bent normal)",
        "anisotropic lobes in tables for one width, as the axis bend says: engines' ways and ours",
        Twin::Estimator(|surface, light, samples| split_sum(samples.bend, surface, light)),
    )
};

/// Computes `P(d, level) (f0 A + B)`.
fn split_sum(bend: &Bend, surface: &Surface, light: &Light) -> DVec3 {
    let Widths(widths) = surface.widths();
    let (x, y) = (widths.x, widths.y);
    let (alpha, strength) = match bend.parameters {
        Parameters::Narrow => (
            y,
            if x > y {
                ((x - y) / (1.0 - y)).sqrt()
            } else {
                0.0
            },
        ),
        Parameters::Mean => (0.5 * (x + y), (x - y) / (x + y)),
        Parameters::Geometric => ((x * y).sqrt(), ((1.0 - y / x) / 0.9).min(1.0)),
        Parameters::Square => (surface.alpha, 0.0),
    };
    let (frame, pr) = (surface.frame(), alpha.sqrt());
    let v = frame.to_local(surface.v);
    let g = DVec3::new(v.x, 0.0, v.z);
    let quartic = |width: f64| 1.0 - (1.0 - strength * (1.0 - width)).powi(4);
    let normal = match bend.normal {
        Normal::Plain => DVec3::Z,
        Normal::Linear => DVec3::Z.lerp(g, strength * (5.0 * pr).min(1.0)),
        Normal::Quartic => DVec3::Z.lerp(g, quartic(pr)),
        Normal::QuarticUnit => DVec3::Z.lerp(g.normalize(), quartic(pr)),
        Normal::QuarticAlpha => DVec3::Z.lerp(g.normalize(), quartic(alpha)),
        Normal::QuarticRoot => DVec3::Z.lerp(g.normalize(), quartic(pr.sqrt())),
        Normal::Root => DVec3::Z.lerp(g, strength * (1.5 * pr.sqrt()).min(1.0)),
        Normal::Cap => {
            let standard = (widths * v.truncate()).extend(v.z).normalize();
            (widths * standard.truncate()).extend(0.5 * (1.0 + standard.z))
        }
    };
    let normal = normal.normalize();
    let mirror = reflect(v, normal);
    let mut level = alpha;
    let direction = match bend.toward {
        Toward::Mirror => mirror,
        Toward::Normal => mirror.lerp(DVec3::Z, alpha * alpha),
        Toward::Bent => mirror.lerp(normal, alpha),
        Toward::BentLess => mirror.lerp(normal, alpha * alpha),
        Toward::Twice => normal.lerp(
            mirror.lerp(normal, alpha * alpha).normalize(),
            share_of_r(alpha),
        ),
        Toward::Unity => {
            level = (pr * (1.2 - strength).min(1.0)).powi(2);
            let smoothness = 1.0 - level;
            let share = (smoothness * smoothness + smoothness * v.z * v.z).min(1.0);
            let bent = DVec3::Z.lerp(mirror, (smoothness.sqrt() + level) * share);
            let back = level * level;
            bent.lerp(mirror, back * back * (3.0 - 2.0 * back))
        }
        Toward::Cap => {
            let wide = DVec3::Z
                .lerp(reflect(v, DVec3::Z), share_of_r(alpha))
                .normalize();
            mirror.lerp(wide, ((alpha - 0.4) / 0.4).clamp(0.0, 1.0))
        }
    };
    let pair = light.dfg(
        v.z,
        if bend.dfg == DfgWidth::Square {
            surface.alpha
        } else {
            alpha
        },
    );
    light.mean_radiance(frame.to_world(direction.normalize()), level)
        * (surface.f0 * pair.x + pair.y)
}
