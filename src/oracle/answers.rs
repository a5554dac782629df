//! Answers tables of queries.

use super::{Integral, Kind, LAYERS, Queries, Sheen, rungs};
use crate::base::csv::{Cell, to_text};
use crate::base::math::equirect_quadrature::EquirectQuadrature;
use crate::base::math::quadrature::{Bounded, Estimate, Tolerance};
use crate::base::math::spherical_harmonics::COUNT;
use crate::base::pixels::{PixelsError, write_atomically};
use crate::instrument::brdf::MaskingShadowing;
use crate::instrument::precompute::dfg::reference::dfg;
use crate::instrument::precompute::irradiance::reference::irradiance;
use crate::instrument::precompute::prefilter::reference::prefilter;
use crate::instrument::precompute::sh9::reference::project_bilinear_bounded;
use crate::instrument::precompute::{PrecomputeSettings, exact_quadrature};
use crate::instrument::shade::Method;
use crate::instrument::shade::coat::{self, COAT_RENDERERS};
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
        let mut colors = self.kind.colors();
        let mut numbers = self.kind.columns().numbers.to_vec();
        for (_, color, number) in LAYERS
            .iter()
            .filter(|(asks, ..)| self.columns.iter().any(|column| column == asks))
        {
            colors.push(color.to_string());
            numbers.push(number);
        }
        let color_columns = colors.iter().flat_map(|color| {
            ["", "error_"].iter().flat_map(move |what| {
                ["r", "g", "b"].map(|channel| format!("{color}_{what}{channel}"))
            })
        });
        let numbers = numbers.iter().map(|name| name.to_string());
        let columns = self
            .columns
            .iter()
            .cloned()
            .chain(color_columns)
            .chain(numbers)
            .collect();

        let mut found: Vec<Option<Numbers>> = self.queries.iter().map(|_| None).collect();
        // One environment at a time: prepared maps are large.
        let groups = self
            .environments
            .iter()
            .enumerate()
            .map(|(i, e)| (Some(i), Some(e)))
            .chain([(None, None)]);
        for (index, environment) in groups {
            let members: Vec<usize> = (0..self.queries.len())
                .filter(|&row| self.queries[row].environment == index)
                .collect();
            if members.is_empty() {
                continue;
            }
            let quadrature = environment.map(|environment| exact_quadrature(&environment.image));
            // The same for all normals.
            let needs_sh9 = self.kind == Kind::Sh9;
            let sh9 = quadrature
                .as_ref()
                .filter(|_| needs_sh9)
                .map(project_bilinear_bounded);
            let answered: Vec<Numbers> = members
                .par_iter()
                .map(|&row| {
                    let numbers = answer(
                        &self.queries[row].integral,
                        quadrature.as_ref(),
                        sh9.as_ref(),
                        tolerance,
                    );
                    done();
                    numbers
                })
                .collect();
            for (row, numbers) in members.into_iter().zip(answered) {
                found[row] = Some(numbers);
            }
        }
        let found: Vec<Numbers> = found.into_iter().flatten().collect();
        let unmet = found.iter().filter(|numbers| !numbers.is_met).count();
        let is_finite = |numbers: &Numbers| numbers.values.iter().all(|value| value.is_finite());
        let not_finite = (1..)
            .zip(&found)
            .filter(|(_, numbers)| !is_finite(numbers))
            .map(|(row, _)| row)
            .collect();
        let with_numbers = |(cells, numbers): (&Vec<Cell>, &Numbers)| {
            cells
                .iter()
                .cloned()
                .chain(numbers.values.iter().map(|&value| value.into()))
                .collect()
        };
        Answers {
            columns,
            rows: self.cells.iter().zip(&found).map(with_numbers).collect(),
            unmet,
            not_finite,
        }
    }
}

fn answer(
    integral: &Integral,
    environment: Option<&EquirectQuadrature>,
    sh9: Option<&Estimate<COUNT>>,
    tolerance: Tolerance,
) -> Numbers {
    let environment = || environment.expect("the environment of the query was prepared");
    let (colors, judged) = match integral {
        Integral::Shading {
            surface,
            coat,
            sheen,
        } => {
            let answer = integrate(environment(), surface, tolerance);
            // The integration judges itself by the terms with F = 1; the others are sums of the
            // same parts.
            let mut judged = vec![answer.specular_white, answer.diffuse];
            let mut colors = vec![
                answer.specular,
                answer.specular_white,
                answer.diffuse_transmitted,
                answer.diffuse,
            ];
            let n_dot_v = surface.n.dot(surface.v);
            let mut kept = Vec::new();
            if let Some(coat) = coat {
                let pair = dfg(surface.model, surface.masking, n_dot_v, coat.alpha);
                let pair = DVec2::new(pair.f0_scale, pair.f90_scale);
                let shares = coat::shares(
                    coat.layering,
                    &COAT_RENDERERS[0],
                    coat.weight,
                    n_dot_v,
                    pair,
                );
                let f0 = DVec3::splat(coat.layering.f0());
                let lobe = Surface::new(
                    surface.model,
                    surface.masking,
                    coat.alpha,
                    f0,
                    [surface.n, surface.v],
                );
                let over = integrate(environment(), &lobe, tolerance);
                let Bounded { value, error } = over.specular;
                colors.push(Bounded {
                    value: shares.coat * value,
                    error: shares.coat * error,
                });
                judged.push(over.specular_white);
                kept.push(shares.base[0]);
            }
            if let Some(Sheen {
                color,
                alpha,
                visibility,
            }) = *sheen
            {
                let masking = MaskingShadowing::Correlated;
                let lobe = Surface::new(
                    visibility,
                    masking,
                    alpha,
                    DVec3::ONE,
                    [surface.n, surface.v],
                );
                let over = specular(environment(), &lobe, tolerance);
                let albedo = dfg(visibility, masking, n_dot_v, alpha).albedo();
                colors.push(over.combine([color, DVec3::ZERO]));
                judged.push(over.combine([DVec3::ONE, DVec3::ZERO]));
                kept.push(sheen::shares(None, color, alpha, n_dot_v, albedo)[0].x);
            }
            let mut found = numbers(&colors, &judged, tolerance);
            found.values.extend(kept);
            return found;
        }
        Integral::Ladder { surface, levels } => {
            let settings = PrecomputeSettings {
                prefilter_level_count: *levels,
                ..PrecomputeSettings::default()
            };
            let rung = |method: &Method| match method.twin {
                Twin::Mean(mean) => mean(environment(), surface, &settings, tolerance),
                Twin::Estimator(_) => unreachable!("{} is an integral", method.name),
            };
            let drawn: Vec<Bounded> = rungs().map(rung).collect();
            (drawn.clone(), drawn)
        }
        Integral::Dfg {
            model,
            masking,
            alpha,
            n_dot_v,
        } => {
            let pair = dfg(*model, *masking, *n_dot_v, *alpha);
            return Numbers {
                values: vec![pair.f0_scale, pair.f90_scale, pair.albedo(), pair.error],
                is_met: pair.error.is_finite(),
            };
        }
        Integral::Prefilter { kernel, alpha, r } => {
            let value = prefilter(environment(), *kernel, *alpha, *r, tolerance);
            (vec![value], vec![value])
        }
        Integral::Irradiance { n } => {
            let value = irradiance(environment(), *n, tolerance);
            (vec![value], vec![value])
        }
        Integral::Sh9 => {
            let Estimate { value, error } = sh9.expect("coefficients of the environment");
            (
                value
                    .iter()
                    .zip(error)
                    .map(|(&value, &error)| Bounded { value, error })
                    .collect(),
                Vec::new(),
            )
        }
    };
    numbers(&colors, &judged, tolerance)
}

fn numbers(colors: &[Bounded], judged: &[Bounded], tolerance: Tolerance) -> Numbers {
    let channels = |color: DVec3| color.to_array();
    let values = colors
        .iter()
        .flat_map(|color| {
            channels(color.value)
                .into_iter()
                .chain(channels(color.error))
        })
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
