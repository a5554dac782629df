//! The score of SH, by the irradiance of its coefficients.

use super::directions::Directions;
use super::fit::gain_in_words;
use super::level::{DOUBT, GOOD_WORDS};
use super::{EXPLAINED, Errors, GOOD, Truth, errors};
use crate::bakes::convention::Axes;
use crate::bakes::sh::{Coefficients, turned};
use crate::environment::layout::LAYOUTS;
use crate::math::equirect_quadrature::EquirectQuadrature;
use crate::math::spherical_harmonics::{DEGREE, irradiance};
use crate::precompute::sh9::reference::{Sh9, project_bilinear};
use glam::DVec3;
use std::f64::consts::PI;

/// Side of the cube of normals.
const SIDE: u32 = 16;

#[derive(Clone, Debug)]
pub struct ShScore {
    /// Errors of the irradiance, against the exact coefficients up to degree 2.
    pub errors: Errors,
    /// Largest error of a coefficient over the largest coefficient.
    pub max_error: f64,
    pub better: Option<Axes>,
    pub verdict: String,
}

/// Scores coefficients; `axes` are the axes of the bake's maps.
pub fn score(truth: &Truth, found: &Coefficients, axes: Axes) -> ShScore {
    let image = &truth.environment.image;
    let exact = project_bilinear(&EquirectQuadrature::new(image.width, image.height, |x, y| image.get(x, y)));
    let directions = Directions::new(&LAYOUTS[0], Axes::SAME, [SIDE; 2]);
    let of = |sh: &Sh9, turn: &dyn Fn(DVec3) -> DVec3| -> Vec<DVec3> {
        directions.world.iter().map(|normal| irradiance(sh, turn(*normal)) / PI).collect()
    };
    let exact_values = of(&exact, &|normal| normal);
    let score = |axes: Axes| {
        let values = of(&found.radiance, &|normal| axes.to_file(normal));
        errors(&directions, &values, &exact_values, truth.epsilon(), 1.0)
    };
    let errors = score(axes);
    let largest = exact.iter().map(|value| value.abs().max_element()).fold(0.0, f64::max);
    let turned = turned(&found.radiance, |world| axes.to_file(world));
    let largest_error = turned.iter().zip(&exact).map(|(own, exact)| (*own - *exact).abs().max_element());
    let max_error = largest_error.fold(0.0, f64::max) / largest.max(f64::MIN_POSITIVE);
    let best = Axes::all().map(|axes| (score(axes).relmse, axes)).min_by(|a, b| a.0.total_cmp(&b.0));
    let better = best.filter(|(relmse, better)| *better != axes && *relmse < EXPLAINED * errors.relmse);
    let window = window(&turned, &exact);
    let left =
        turned.iter().zip(&exact).zip(DEGREE).map(|((own, exact), l)| (*own - *exact * window[l]).length_squared());
    let off = turned.iter().zip(&exact).map(|(own, exact)| (*own - *exact).length_squared()).sum::<f64>();
    let verdict = match better {
        _ if errors.relmse <= GOOD => GOOD_WORDS.to_owned(),
        Some((relmse, axes)) => format!("axes {axes} fit better: relmse {relmse:.1e}"),
        _ if left.sum::<f64>() > EXPLAINED * off => "wrong, and no factor a degree explains it".to_owned(),
        _ if (window[0] - 1.0).abs() < 0.05 => {
            format!("windowed against ringing: degree 1 times {:.2}, degree 2 times {:.2}", window[1], window[2])
        }
        _ => gain_in_words(window[0]),
    };
    ShScore { errors, max_error, better: better.map(|(_, axes)| axes), verdict }
}

impl ShScore {
    /// Removes factors from the verdict because the axes or the light do not fit.
    pub fn doubt(&mut self) {
        if self.errors.relmse > GOOD && self.better.is_none() {
            self.verdict = DOUBT.to_owned();
        }
    }
}

/// Fits a factor to each degree of the exact coefficients.
fn window(own: &Sh9, exact: &Sh9) -> [f64; 3] {
    let (mut products, mut squares) = ([0.0; 3], [f64::MIN_POSITIVE; 3]);
    for ((own, exact), l) in own.iter().zip(exact).zip(DEGREE) {
        products[l] += own.dot(*exact);
        squares[l] += exact.length_squared();
    }
    std::array::from_fn(|l| products[l] / squares[l])
}
