//! The split sum of an anisotropic lobe about a bent normal, by the axis `bend`
//! ([`crate::instrument::shade::bend`]).

use super::Method;
use super::split_sum::shifted;
use super::split_sum_engines::share_of_r;
use crate::instrument::brdf::reflect;
use crate::instrument::shade::bend::{Bend, Normal, OneWidth, Parameters, Toward};
use crate::instrument::shade::reference::Surface;
use crate::instrument::shade::twin::{Light, Twin};
use glam::{DVec2, DVec3};

pub const METHOD: Method = Method {
    uses_bend: true,
    ..shifted(
        "split-sum-bent",
        "Split sum (bent normal)",
        "anisotropic lobes in tables for one width, as the axis bend says: engines' ways and ours",
        Twin::Estimator(|surface, light, samples| split_sum(samples.bend, surface, light)),
    )
};

/// A lobe of two widths by the parameters of a renderer, and its view. Vectors are local.
struct BentLobe {
    v: DVec3,
    /// Narrower width last.
    widths: DVec2,
    alpha: f64,
    strength: f64,
}

/// What is looked up: a local direction, not normalised, and the alpha of the level.
struct Lookup {
    direction: DVec3,
    alpha: f64,
}

/// Computes `P(d, level) (f0 A + B)`.
fn split_sum(bend: &Bend, surface: &Surface, light: &Light) -> DVec3 {
    let frame = surface.frame();
    let lobe = BentLobe::new(bend.parameters, surface, frame.to_local(surface.v));
    let lookup = lobe.lookup(bend.toward, lobe.normal(bend.normal));
    let pair = light.dfg(lobe.v.z, bend.table_alpha(surface.widths()));
    light.mean_radiance(frame.to_world(lookup.direction.normalize()), lookup.alpha)
        * (surface.f0 * pair.x + pair.y)
}

impl BentLobe {
    fn new(parameters: Parameters, surface: &Surface, v: DVec3) -> Self {
        let widths = surface.widths();
        let OneWidth { alpha, strength } = parameters.of(widths);
        Self {
            v,
            widths: widths.0,
            alpha,
            strength,
        }
    }

    /// Returns the unit bent normal.
    fn normal(&self, normal: Normal) -> DVec3 {
        let Self {
            v,
            widths,
            alpha,
            strength,
        } = *self;
        let pr = alpha.sqrt();
        let g = DVec3::new(v.x, 0.0, v.z);
        let quartic = |width: f64| 1.0 - (1.0 - strength * (1.0 - width)).powi(4);
        let bent = match normal {
            Normal::Plain => DVec3::Z,
            Normal::Strength => DVec3::Z.lerp(g, strength),
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
        bent.normalize()
    }

    /// Returns the lookup for a bent normal.
    fn lookup(&self, toward: Toward, normal: DVec3) -> Lookup {
        let Self {
            v,
            alpha,
            strength,
            widths: _,
        } = *self;
        let mirror = reflect(v, normal);
        let direction = match toward {
            Toward::Mirror => mirror,
            Toward::Normal => mirror.lerp(DVec3::Z, alpha * alpha),
            Toward::Bent => mirror.lerp(normal, alpha),
            Toward::BentLess => mirror.lerp(normal, alpha * alpha),
            Toward::Twice => normal.lerp(
                mirror.lerp(normal, alpha * alpha).normalize(),
                share_of_r(alpha),
            ),
            Toward::Unity => {
                let level = (alpha.sqrt() * (1.2 - strength).min(1.0)).powi(2);
                let smoothness = 1.0 - level;
                let share = (smoothness * smoothness + smoothness * v.z * v.z).min(1.0);
                let bent = DVec3::Z.lerp(mirror, (smoothness.sqrt() + level) * share);
                let back = level * level;
                return Lookup {
                    direction: bent.lerp(mirror, back * back * (3.0 - 2.0 * back)),
                    alpha: level,
                };
            }
            Toward::Cap => {
                let wide = DVec3::Z
                    .lerp(reflect(v, DVec3::Z), share_of_r(alpha))
                    .normalize();
                mirror.lerp(wide, ((alpha - 0.4) / 0.4).clamp(0.0, 1.0))
            }
        };
        Lookup { direction, alpha }
    }
}
