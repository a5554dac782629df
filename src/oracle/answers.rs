//! Answers tables of queries.

use super::{Coat, Integral, Kind, LAYERS, Queries, Sheen, rungs};
use crate::base::csv::{Cell, to_text};
use crate::base::math::equirect_quadrature::EquirectQuadrature;
use crate::base::math::quadrature::{Bounded, Estimate, Tolerance};
use crate::base::math::spherical_harmonics::COUNT;
use crate::base::pixels::{PixelsError, write_atomically};
use crate::instrument::brdf::MaskingShadowing;
use crate::instrument::environment::Environment;
use crate::instrument::precompute::dfg::reference::dfg;
use crate::instrument::precompute::irradiance::reference::irradiance;
use crate::instrument::precompute::prefilter::reference::prefilter;
use crate::instrument::precompute::sh9::reference::project_bilinear_bounded;
use crate::instrument::precompute::{PrecomputeSettings, exact_quadrature};
use crate::instrument::shade::Method;
use crate::instrument::shade::coat::{COAT_RENDERERS, CoatLaw};
use crate::instrument::shade::reference::{Surface, integrate, specular};
use crate::instrument::shade::sheen;
use crate::instrument::shade::twin::Twin;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::io::Write;
use std::path::Path;

#[derive(Debug)]
pub struct Answers {
    /// The columns of the queries, then the answers' columns.
    pub columns: Vec<String>,
    pub rows: Vec<Vec<Cell>>,
    /// Rows whose integration reached its cap of parts before the requested error; their bounds
    /// have the reached error.
    pub unmet: usize,
    /// Rows, from 1, with a number that is not finite: a direction or cosine too small for f64.
    pub not_finite: Vec<usize>,
}

struct Numbers {
    values: Vec<f64>,
    /// Whether the integration met its tolerance.
    is_met: bool,
}

impl Queries {
    /// Answers every row, in parallel and in order, and calls `done` after each, from any thread.
    ///
    /// `tolerance` does not apply to DFG pairs (5e-7) and SH9 (1e-9), which are cheap.
    pub fn answer(&self, tolerance: Tolerance, done: impl Fn() + Sync) -> Answers {
        let found = self.numbers(tolerance, done);
        let unmet = found.iter().filter(|numbers| !numbers.is_met).count();
        let is_finite = |numbers: &Numbers| numbers.values.iter().all(|value| value.is_finite());
        let not_finite = (1..)
            .zip(&found)
            .filter(|(_, numbers)| !is_finite(numbers))
            .map(|(row, _)| row)
            .collect();
        let rows = self
            .cells
            .iter()
            .zip(&found)
            .map(|(cells, numbers)| {
                let numbers = numbers.values.iter().map(|&value| value.into());
                cells.iter().cloned().chain(numbers).collect()
            })
            .collect();
        Answers {
            columns: self.answer_columns(),
            rows,
            unmet,
            not_finite,
        }
    }

    /// Lists the columns of the queries, then the columns of the answers.
    fn answer_columns(&self) -> Vec<String> {
        let mut colors = self.kind.colors();
        let mut numbers = self.kind.columns().numbers.to_vec();
        let has_column = |name: &str| self.columns.iter().any(|column| column == name);
        for layer in LAYERS.iter().filter(|layer| has_column(layer.asks)) {
            colors.push(layer.color.to_owned());
            numbers.push(layer.base_share);
        }
        let mut columns = self.columns.clone();
        for color in colors {
            for prefix in ["", "error_"] {
                columns.extend(["r", "g", "b"].map(|channel| format!("{color}_{prefix}{channel}")));
            }
        }
        columns.extend(numbers.into_iter().map(str::to_owned));
        columns
    }

    /// Integrates every row, in order.
    fn numbers(&self, tolerance: Tolerance, done: impl Fn() + Sync) -> Vec<Numbers> {
        let mut found: Vec<Option<Numbers>> = self.queries.iter().map(|_| None).collect();
        // One environment at a time: prepared maps are large.
        let environments = (0..self.environments.len()).map(Some).chain([None]);
        for index in environments {
            let members: Vec<usize> = (0..self.queries.len())
                .filter(|&row| self.queries[row].environment == index)
                .collect();
            if members.is_empty() {
                continue;
            }
            let light = index.map(|index| Light::new(&self.environments[index], self.kind));
            let answered: Vec<Numbers> = members
                .par_iter()
                .map(|&row| {
                    let numbers = answer(&self.queries[row].integral, light.as_ref(), tolerance);
                    done();
                    numbers
                })
                .collect();
            for (row, numbers) in members.into_iter().zip(answered) {
                found[row] = Some(numbers);
            }
        }
        found.into_iter().flatten().collect()
    }
}

/// An environment, prepared for integrals.
struct Light {
    quadrature: EquirectQuadrature,
    /// Its coefficients, the same for all normals; for queries of [`Kind::Sh9`] only.
    sh9: Option<Estimate<COUNT>>,
}

impl Light {
    fn new(environment: &Environment, kind: Kind) -> Self {
        let quadrature = exact_quadrature(&environment.image);
        let sh9 = (kind == Kind::Sh9).then(|| project_bilinear_bounded(&quadrature));
        Self { quadrature, sh9 }
    }
}

fn answer(integral: &Integral, light: Option<&Light>, tolerance: Tolerance) -> Numbers {
    let light = || light.expect("the environment of the query was prepared");
    let quadrature = || &light().quadrature;
    match integral {
        Integral::Shading {
            surface,
            coat,
            sheen,
        } => shading(quadrature(), surface, *coat, *sheen, tolerance),
        Integral::Ladder { surface, levels } => ladder(quadrature(), surface, *levels, tolerance),
        Integral::Dfg {
            model,
            masking,
            alpha,
            n_dot_v,
        } => {
            let pair = dfg(*model, *masking, *n_dot_v, *alpha);
            Numbers {
                values: vec![pair.f0_scale, pair.f90_scale, pair.albedo(), pair.error],
                is_met: pair.error.is_finite(),
            }
        }
        Integral::Prefilter { kernel, alpha, r } => {
            let value = prefilter(quadrature(), *kernel, *alpha, *r, tolerance);
            numbers(&[value], &[value], tolerance)
        }
        Integral::Irradiance { n } => {
            let value = irradiance(quadrature(), *n, tolerance);
            numbers(&[value], &[value], tolerance)
        }
        Integral::Sh9 => {
            let sh9 = light().sh9.as_ref();
            let Estimate { value, error } = sh9.expect("coefficients of the environment");
            let coefficients: Vec<Bounded> = value
                .iter()
                .zip(error)
                .map(|(&value, &error)| Bounded { value, error })
                .collect();
            numbers(&coefficients, &[], tolerance)
        }
    }
}

/// Integrates the terms of a point and of its layers.
fn shading(
    light: &EquirectQuadrature,
    surface: &Surface,
    coat: Option<Coat>,
    sheen: Option<Sheen>,
    tolerance: Tolerance,
) -> Numbers {
    let answer = integrate(light, surface, tolerance);
    // The integration judges itself by the terms with F = 1; the others are sums of the same
    // parts.
    let mut judged = vec![answer.specular_white, answer.diffuse];
    let mut colors = vec![
        answer.specular,
        answer.specular_white,
        answer.diffuse_transmitted,
        answer.diffuse,
    ];
    let mut base_shares = Vec::new();
    let layers = [
        coat.map(|coat| over_coat(light, surface, &coat, tolerance)),
        sheen.map(|sheen| over_sheen(light, surface, &sheen, tolerance)),
    ];
    for layer in layers.into_iter().flatten() {
        colors.push(layer.radiance);
        judged.push(layer.judged);
        base_shares.push(layer.base_share);
    }
    let mut found = numbers(&colors, &judged, tolerance);
    found.values.extend(base_shares);
    found
}

/// A layer over a surface.
struct Layer {
    radiance: Bounded,
    /// Its integral with F = 1, by which the integration judges itself.
    judged: Bounded,
    /// The share that the surface below keeps.
    base_share: f64,
}

fn over_coat(
    light: &EquirectQuadrature,
    surface: &Surface,
    coat: &Coat,
    tolerance: Tolerance,
) -> Layer {
    let n_dot_v = surface.n.dot(surface.v);
    let pair = dfg(surface.model, surface.masking, n_dot_v, coat.alpha);
    let pair = DVec2::new(pair.f0_scale, pair.f90_scale);
    let law = CoatLaw::new(coat.layering, &COAT_RENDERERS[0]);
    let shares = law.shares(coat.weight, n_dot_v, pair);
    let f0 = DVec3::splat(coat.layering.f0());
    let directions = [surface.n, surface.v];
    let lobe = Surface::new(surface.model, surface.masking, coat.alpha, f0, directions);
    let reflected = integrate(light, &lobe, tolerance);
    let Bounded { value, error } = reflected.specular;
    Layer {
        radiance: Bounded {
            value: shares.coat * value,
            error: shares.coat * error,
        },
        judged: reflected.specular_white,
        base_share: shares.base_specular,
    }
}

fn over_sheen(
    light: &EquirectQuadrature,
    surface: &Surface,
    sheen: &Sheen,
    tolerance: Tolerance,
) -> Layer {
    let Sheen {
        color,
        alpha,
        visibility,
    } = *sheen;
    let n_dot_v = surface.n.dot(surface.v);
    let masking = MaskingShadowing::Correlated;
    let directions = [surface.n, surface.v];
    let lobe = Surface::new(visibility, masking, alpha, DVec3::ONE, directions);
    let reflected = specular(light, &lobe, tolerance);
    let albedo = dfg(visibility, masking, n_dot_v, alpha).albedo();
    Layer {
        radiance: reflected.combine([color, DVec3::ZERO]),
        judged: reflected.combine([DVec3::ONE, DVec3::ZERO]),
        base_share: sheen::shares(None, color, alpha, n_dot_v, albedo).base.x,
    }
}

/// Integrates the rungs of the ladder of a point.
fn ladder(
    light: &EquirectQuadrature,
    surface: &Surface,
    levels: u32,
    tolerance: Tolerance,
) -> Numbers {
    let settings = PrecomputeSettings {
        prefilter_level_count: levels,
        ..PrecomputeSettings::default()
    };
    let rung = |method: &Method| match method.twin {
        Twin::Mean(mean) => mean(light, surface, &settings, tolerance),
        Twin::Estimator(_) => unreachable!("{} is an integral", method.name),
    };
    let rungs: Vec<Bounded> = rungs().map(rung).collect();
    numbers(&rungs, &rungs, tolerance)
}

/// Lists the values of `colors` and whether the integrals `judged` met the tolerance.
fn numbers(colors: &[Bounded], judged: &[Bounded], tolerance: Tolerance) -> Numbers {
    let values = colors
        .iter()
        .flat_map(|color| [color.value, color.error])
        .flat_map(|rgb| rgb.to_array())
        .collect();
    Numbers {
        values,
        is_met: judged.iter().all(|bounded| is_met(bounded, tolerance)),
    }
}

/// Returns whether the bound meets the tolerance, relative to the brightest channel.
fn is_met(bounded: &Bounded, tolerance: Tolerance) -> bool {
    // Room for the share of Schlick's weight, which is only held to a floor of accuracy if small.
    const SLACK: f64 = 2.0;
    bounded.error.max_element() <= SLACK * tolerance.relative * bounded.value.abs().max_element()
}

impl Answers {
    pub fn to_csv(&self) -> Vec<u8> {
        to_text(&self.columns, self.rows.iter().map(Vec::as_slice))
    }

    /// Writes the table atomically: the file holds the old or the complete new contents.
    pub fn write(&self, path: &Path) -> Result<(), PixelsError> {
        write_atomically(path, |file| file.write_all(&self.to_csv()))
    }
}
