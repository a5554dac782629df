//! The score of SH: its irradiance beside that of the exact coefficients.

use super::directions::Directions;
use super::level::gain_in_words;
use super::{Errors, GOOD, Truth, errors};
use crate::bakes::convention::Axes;
use crate::bakes::sh::Coefficients;
use crate::environment::layout::LAYOUTS;
use crate::math::equirect_quadrature::EquirectQuadrature;
use crate::math::spherical_harmonics::irradiance;
use crate::precompute::sh9::reference::{Sh9, project_bilinear};
use glam::DVec3;

/// Side of the cube of normals.
const SIDE: u32 = 16;

/// How wrong SH is.
#[derive(Clone, Debug)]
pub struct ShScore {
    /// Of the irradiance, against that of the exact coefficients up to degree 2.
    pub errors: Errors,
    /// Largest error of a coefficient over the largest coefficient.
    pub max_error: f64,
    pub verdict: String,
}

/// Scores coefficients; `axes` are those of the maps of the bake.
pub fn score(truth: &Truth, found: &Coefficients, axes: Axes) -> ShScore {
    let image = &truth.environment.image;
    let exact = project_bilinear(&EquirectQuadrature::new(image.width, image.height, |x, y| image.get(x, y)));
    let directions = Directions::new(&LAYOUTS[0], Axes::SAME, [SIDE; 2]);
    let of = |sh: &Sh9, turn: &dyn Fn(DVec3) -> DVec3| -> Vec<DVec3> {
        directions.world.iter().map(|normal| irradiance(sh, turn(*normal)) / std::f64::consts::PI).collect()
    };
    let exact_values = of(&exact, &|normal| normal);
    let score = |axes: Axes| {
        let values = of(&found.radiance, &|normal| axes.to_file(normal));
        errors(&directions, &values, &exact_values, truth.epsilon(), 1.0)
    };
    let errors = score(axes);
    let largest = exact.iter().map(|value| value.abs().max_element()).fold(0.0, f64::max);
    let off = |k: usize| (turned(found, axes)[k] - exact[k]).abs().max_element();
    let max_error = (0..exact.len()).map(off).fold(0.0, f64::max) / largest.max(f64::MIN_POSITIVE);
    let verdict = if errors.relmse <= GOOD {
        format!("good: {:.2} % rms", 100.0 * errors.relmse.sqrt())
    } else {
        let best = Axes::all().map(|axes| (score(axes).relmse, axes)).min_by(|a, b| a.0.total_cmp(&b.0));
        match best {
            Some((relmse, better)) if better != axes && relmse < 0.25 * errors.relmse => {
                format!("axes {better} fit better: relMSE {relmse:.1e}")
            }
            _ if errors.bias_rel.abs() > 0.5 => gain_in_words(1.0 + errors.bias_rel),
            _ => "wrong".to_owned(),
        }
    };
    ShScore { errors, max_error, verdict }
}

/// The coefficients in the world's axes, by projection over the cube of normals: of degree 2 it is exact to its quadrature.
fn turned(found: &Coefficients, axes: Axes) -> Sh9 {
    use crate::math::spherical_harmonics::basis;
    let directions = Directions::new(&LAYOUTS[0], Axes::SAME, [64; 2]);
    let mut sums = Sh9::default();
    for (world, weight) in directions.world.iter().zip(&directions.weights) {
        let (own, file) = (basis(*world), basis(axes.to_file(*world)));
        let value: DVec3 = found.radiance.iter().zip(file).map(|(value, y)| *value * y).sum();
        (0..own.len()).for_each(|k| sums[k] += *weight * own[k] * value);
    }
    sums
}
