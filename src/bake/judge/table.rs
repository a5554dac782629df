//! The score of a DFG table, and the conventions that fit it best.

use super::cause::{Cause, Unknown};
use super::table_borders::{Deviation, wrong_borders};
use super::table_slip::{Integral, Reading, StretchedLines, TableFlags, TableSlip, shaded_alpha};
use super::table_texels::{TableTexel, odd_texels, spread_texels};
use super::verdict::{Quality, Verdict};
use crate::bake::convention::{Convention, TABLE_AXES, TABLE_CHANNELS, TableAxes, TableChannels};
use crate::base::names::Listed;
use crate::base::pixels::RgbImage;
use crate::instrument::brdf::{Brdf, MaskingShadowing, alpha_from_perceptual_roughness};
use crate::instrument::precompute::dfg::reference::{dfg_by, dfg_masked_by};
use glam::DVec2;
use rayon::prelude::*;
use std::collections::HashMap;

/// Approximate number of compared rows and columns, edges included.
const LINES: u32 = 17;
/// Number of rows and columns in a search of conventions.
const LINES_SEARCHED: u32 = 7;
/// Root mean square error of a table that is something else.
const RMS_OTHER: f64 = 0.15;
/// Largest root mean square error of a convention that fits: as much as masking makes.
const RMS_CLOSE: f64 = 0.02;
/// Largest share of the error that a slip may leave.
const SHARE_LEFT: f64 = 0.5;
/// Largest error of a good table: a step of 8 bits.
const GOOD: f64 = 1.0 / 255.0;
/// Below this n·v the mean of few samples errs most.
pub const GRAZING: f64 = 0.5;

/// Bounds on the relative error of the integrals in a score and in a search.
const SCORED_WITHIN: f64 = 1e-5;
const SEARCHED_WITHIN: f64 = 1e-3;
/// Narrowest lobe that is integrated, alpha.
const ALPHA_NARROWEST: f64 = 1e-6;
/// Smallest n·v and roughness at which a slip is compared.
const PARAMETER_MIN: f64 = 1e-3;

/// The score of a DFG table.
#[derive(Clone, Debug)]
pub struct TableScore {
    /// Largest error of A or B.
    pub max_error: f64,
    /// Root mean square error of A and B.
    pub rms: f64,
    /// n·v and perceptual roughness of the largest error.
    pub worst: DVec2,
    /// Number of compared texels.
    pub count: usize,
    pub verdict: Verdict,
}

fn deviations(
    table: &RgbImage,
    brdf: &'static dyn Brdf,
    axes: &TableAxes,
    channels: &TableChannels,
    masking: MaskingShadowing,
) -> Vec<Deviation> {
    let mut texels = spread_texels(table, LINES);
    texels.extend(odd_texels(table));
    let deviation = |texel: &TableTexel| {
        let parameters = axes.parameters(texel.uv);
        let found = (channels.pair)(texel.value);
        let clamped = found - exact(brdf, masking, parameters, SCORED_WITHIN);
        // Programs clamp narrow lobes at different widths, or not at all.
        let alpha = alpha_from_perceptual_roughness(parameters.y);
        let unclamped = (alpha < shaded_alpha(parameters.y)).then(|| {
            let widths = [alpha.max(ALPHA_NARROWEST); 2];
            found - pair(brdf, masking, parameters.x, widths, SCORED_WITHIN)
        });
        let error = unclamped
            .filter(|other| other.abs().max_element() < clamped.abs().max_element())
            .unwrap_or(clamped);
        Deviation {
            uv: texel.uv,
            parameters,
            max: error.abs().max_element(),
            mean_square: 0.5 * error.length_squared(),
        }
    };
    texels.par_iter().map(deviation).collect()
}

fn root_mean_square(deviations: &[Deviation]) -> f64 {
    let sum: f64 = deviations
        .iter()
        .map(|deviation| deviation.mean_square)
        .sum();
    (sum / deviations.len() as f64).sqrt()
}

/// Scores a table against integrals in f64 at texel centres.
pub fn score(table: &RgbImage, brdf: &'static dyn Brdf, convention: &Convention) -> TableScore {
    let deviations = deviations(
        table,
        brdf,
        convention.table_axes,
        convention.table_channels,
        convention.masking,
    );
    let worst = deviations
        .iter()
        .copied()
        .max_by(|a, b| a.max.total_cmp(&b.max))
        .unwrap_or_default();
    let rms = root_mean_square(&deviations);
    let verdict = if worst.max > GOOD {
        Verdict::from_causes(causes(table, brdf, convention, &deviations, worst.max))
    } else {
        Verdict::Good(Quality::Table)
    };
    TableScore {
        max_error: worst.max,
        rms,
        worst: worst.parameters,
        count: deviations.len(),
        verdict,
    }
}

/// Names wrong borders, a slip of the whole table, or too few samples.
fn causes(
    table: &RgbImage,
    brdf: &'static dyn Brdf,
    convention: &Convention,
    deviations: &[Deviation],
    max_error: f64,
) -> Vec<Cause> {
    let noise = Cause::Table(TableSlip::TooFewSamples);
    let is_grazing = |deviation: &Deviation| deviation.parameters.x < GRAZING;
    if let Some(borders) = wrong_borders([table.width, table.height], deviations, GOOD, is_grazing)
    {
        return vec![Cause::Table(TableSlip::Borders(borders))];
    }
    let suspect = Suspect::new(table, brdf, convention);
    let rms = root_mean_square(deviations);
    let cause = suspect.cause(rms, max_error);
    if !cause.is_unknown() {
        return vec![cause];
    }
    let is_good_beyond_grazing = deviations
        .iter()
        .all(|deviation| is_grazing(deviation) || deviation.max <= GOOD);
    if is_good_beyond_grazing {
        return vec![noise];
    }
    match suspect.masking_beyond_grazing() {
        Some(convention) => vec![Cause::Table(convention), noise],
        None => vec![cause],
    }
}

/// A slip in where or how the texels of a table are read.
#[derive(Clone, Copy)]
enum Misreading {
    /// Texels are sampled this many texels off.
    Shift(DVec2),
    Stretch(StretchedLines),
    Reading(Reading),
}

impl Misreading {
    /// Lists shifts along columns, rows and both, stretches, and readings.
    fn all() -> Vec<Self> {
        let shifts = StretchedLines::ALL.into_iter().flat_map(|lines| {
            [-1.0, -0.5, 0.5, 1.0].map(|texels| Self::Shift(lines.axes() * texels))
        });
        shifts
            .chain(StretchedLines::ALL.map(Self::Stretch))
            .chain(Reading::ALL.map(Self::Reading))
            .collect()
    }

    fn slip(self, share_left: f64) -> TableSlip {
        match self {
            Self::Shift(texels) => TableSlip::Shift { texels, share_left },
            Self::Stretch(lines) => TableSlip::Stretch { lines, share_left },
            Self::Reading(reading) => TableSlip::Reading {
                reading,
                share_left,
            },
        }
    }
}

/// A table that is not good, and the texels that are compared under each slip.
struct Suspect<'a> {
    table: &'a RgbImage,
    brdf: &'static dyn Brdf,
    convention: &'a Convention,
    texels: Vec<TableTexel>,
}

impl<'a> Suspect<'a> {
    fn new(table: &'a RgbImage, brdf: &'static dyn Brdf, convention: &'a Convention) -> Self {
        Self {
            table,
            brdf,
            convention,
            texels: spread_texels(table, LINES_SEARCHED),
        }
    }

    /// Finds the slip that leaves least of the rms and largest errors.
    fn cause(&self, rms: f64, max_error: f64) -> Cause {
        let best = search(self.table, self.brdf).swap_remove(0);
        let flags = best.flags(self.convention);
        if !flags.is_empty() && best.rms < (SHARE_LEFT * rms).min(RMS_CLOSE) {
            let left = deviations(
                self.table,
                self.brdf,
                best.axes,
                best.channels,
                best.masking,
            );
            return Cause::Table(TableSlip::Convention {
                flags,
                rms_left: root_mean_square(&left),
            });
        }
        let slip = self
            .integral_or_misreading()
            .or_else(|| self.misreading_of(&best));
        slip.map_or(
            Cause::Unknown(if rms > RMS_OTHER {
                Unknown::OtherTable
            } else {
                Unknown::Table { max_error }
            }),
            Cause::Table,
        )
    }

    /// Finds another masking that fits where few samples err little.
    fn masking_beyond_grazing(&self) -> Option<TableSlip> {
        let Convention {
            table_axes,
            table_channels,
            masking: assumed,
            ..
        } = *self.convention;
        let max_by = |masking: MaskingShadowing| {
            self.texels
                .iter()
                .filter_map(|texel| {
                    let parameters = compared(table_axes.parameters(texel.uv));
                    (parameters.x >= GRAZING).then(|| {
                        let exact = exact(self.brdf, masking, parameters, SEARCHED_WITHIN);
                        ((table_channels.pair)(texel.value) - exact)
                            .abs()
                            .max_element()
                    })
                })
                .fold(0.0, f64::max)
        };
        let (masking, _) = MaskingShadowing::all()
            .filter(|masking| masking.name() != assumed.name())
            .map(|masking| (*masking, max_by(*masking)))
            .filter(|(_, error)| *error <= GOOD)
            .min_by(|(_, a), (_, b)| a.total_cmp(b))?;
        let left = deviations(self.table, self.brdf, table_axes, table_channels, masking);
        Some(TableSlip::Convention {
            flags: TableFlags {
                masking: Some(masking.name()),
                ..TableFlags::default()
            },
            rms_left: root_mean_square(&left),
        })
    }

    /// Finds another integral or a misreading by the assumed conventions.
    fn integral_or_misreading(&self) -> Option<TableSlip> {
        let Convention {
            table_axes,
            table_channels,
            ..
        } = *self.convention;
        let unchanged = self.rms_by(table_axes, table_channels, None);
        let (misread_rms, misreading) = Misreading::all()
            .into_par_iter()
            .map(|misreading| {
                let rms = self.rms_by(table_axes, table_channels, Some(misreading));
                (rms, misreading)
            })
            .collect::<Vec<_>>()
            .into_iter()
            .min_by(|(a, _), (b, _)| a.total_cmp(b))
            .expect("a misreading is listed");
        let (integral_rms, integral) = Integral::ALL
            .into_par_iter()
            .map(|integral| (self.rms_of(integral), integral))
            .collect::<Vec<_>>()
            .into_iter()
            .min_by(|(a, _), (b, _)| a.total_cmp(b))
            .expect("an integral is listed");
        if integral_rms < (SHARE_LEFT * unchanged.min(misread_rms)).min(RMS_CLOSE) {
            return Some(TableSlip::Integral(integral));
        }
        let is_found = misread_rms < SHARE_LEFT * unchanged;
        is_found.then(|| misreading.slip(misread_rms / unchanged))
    }

    /// Finds another reading by the conventions that fit best.
    fn misreading_of(&self, best: &Fitting) -> Option<TableSlip> {
        let (rms, reading) = Reading::ALL
            .into_iter()
            .map(|reading| {
                let misreading = Some(Misreading::Reading(reading));
                (self.rms_by(best.axes, best.channels, misreading), reading)
            })
            .min_by(|(a, _), (b, _)| a.total_cmp(b))
            .expect("a reading is listed");
        // The masking hardly matters here.
        let flags = TableFlags {
            masking: None,
            ..best.flags(self.convention)
        };
        (rms < RMS_CLOSE).then_some(TableSlip::ConventionAndReading { flags, reading })
    }

    /// Returns the rms error by conventions and a misreading.
    fn rms_by(
        &self,
        axes: &TableAxes,
        channels: &TableChannels,
        misreading: Option<Misreading>,
    ) -> f64 {
        let size = DVec2::new(self.table.width.into(), self.table.height.into());
        let texel_size = 1.0 / size;
        // A table sampled at texel corners is shifted by up to a texel, or stretched.
        let shift = match misreading {
            Some(Misreading::Shift(texels)) => texels,
            _ => DVec2::ZERO,
        };
        let stretch = match misreading {
            Some(Misreading::Stretch(lines)) => lines.axes(),
            _ => DVec2::ZERO,
        };
        let stretch = 1.0 + stretch * texel_size / (1.0 - texel_size);
        self.rms(|texel| {
            let uv = 0.5 + (texel.uv - 0.5) * stretch + shift * texel_size;
            let mut parameters = compared(axes.parameters(uv));
            let mut value = texel.value;
            if let Some(Misreading::Reading(reading)) = misreading {
                parameters = reading.parameters(parameters);
                value = reading.values(value);
            }
            let masking = self.convention.masking;
            (channels.pair)(value) - exact(self.brdf, masking, parameters, SEARCHED_WITHIN)
        })
    }

    /// Returns the rms error from another integral.
    fn rms_of(&self, integral: Integral) -> f64 {
        let Convention {
            table_axes,
            table_channels,
            ..
        } = *self.convention;
        let masking = integral.masking().unwrap_or(self.convention.masking);
        // Other integrals may exceed 1, where an image of integers is cut.
        let most = self
            .texels
            .iter()
            .map(|texel| texel.value.max_element())
            .fold(0.0, f64::max);
        self.rms(|texel| {
            let parameters = compared(table_axes.parameters(texel.uv));
            let roughness = parameters.y;
            let widths = [shaded_alpha(roughness), integral.masking_width(roughness)];
            let n_dot_v = parameters.x;
            let facet = |v_dot_h, n_dot_h| integral.facet(v_dot_h, n_dot_h, n_dot_v);
            let dfg = dfg_by(self.brdf, masking, n_dot_v, widths, SEARCHED_WITHIN, facet);
            let cut = DVec2::new(dfg.f0_scale, dfg.f90_scale).min(DVec2::splat(most));
            (table_channels.pair)(texel.value) - cut
        })
    }

    fn rms(&self, error: impl Fn(&TableTexel) -> DVec2) -> f64 {
        let squares = self
            .texels
            .iter()
            .map(|texel| error(texel).length_squared());
        (0.5 * squares.sum::<f64>() / self.texels.len() as f64).sqrt()
    }
}

fn compared(parameters: DVec2) -> DVec2 {
    parameters.clamp(DVec2::splat(PARAMETER_MIN), DVec2::ONE)
}

/// Conventions of a table, and the rms error by them.
pub struct Fitting {
    pub axes: &'static TableAxes,
    pub channels: &'static TableChannels,
    pub masking: MaskingShadowing,
    pub rms: f64,
}

impl Fitting {
    /// Returns what differs from the assumed conventions.
    fn flags(&self, assumed: &Convention) -> TableFlags {
        let other = |found: &'static str, assumed: &str| (found != assumed).then_some(found);
        TableFlags {
            axes: other(self.axes.name, assumed.table_axes.name),
            channels: other(self.channels.name, assumed.table_channels.name),
            masking: other(self.masking.name(), assumed.masking.name()),
        }
    }
}

/// Integrals at the parameters of texels, by their bits.
type Known = HashMap<[u64; 2], DVec2>;

fn key(parameters: DVec2) -> [u64; 2] {
    parameters.to_array().map(f64::to_bits)
}

/// Returns the parameters of a texel, rounded: the eight orders of axes share them, so each is
/// integrated once.
fn rounded_parameters(axes: &TableAxes, texel: &TableTexel) -> DVec2 {
    (axes.parameters(texel.uv) * 65536.0).round() / 65536.0
}

/// Tries all conventions, best first.
pub fn search(table: &RgbImage, brdf: &'static dyn Brdf) -> Vec<Fitting> {
    let texels = spread_texels(table, LINES_SEARCHED);
    let mut wanted: Vec<DVec2> = TABLE_AXES
        .iter()
        .flat_map(|axes| {
            texels
                .iter()
                .map(move |texel| rounded_parameters(axes, texel))
        })
        .collect();
    wanted.sort_by_key(|parameters| key(*parameters));
    wanted.dedup();
    let mut fits = Vec::new();
    for masking in MaskingShadowing::all() {
        let known: Known = wanted
            .par_iter()
            .map(|parameters| {
                let exact = exact(brdf, *masking, *parameters, SEARCHED_WITHIN);
                (key(*parameters), exact)
            })
            .collect();
        for axes in TABLE_AXES {
            for channels in TABLE_CHANNELS {
                fits.push(Fitting {
                    axes,
                    channels,
                    masking: *masking,
                    rms: rms_of_known(&texels, axes, channels, &known),
                });
            }
        }
    }
    fits.sort_by(|a, b| a.rms.total_cmp(&b.rms));
    fits
}

fn rms_of_known(
    texels: &[TableTexel],
    axes: &TableAxes,
    channels: &TableChannels,
    known: &Known,
) -> f64 {
    let square = |texel: &TableTexel| {
        let exact = known[&key(rounded_parameters(axes, texel))];
        ((channels.pair)(texel.value) - exact).length_squared()
    };
    let sum: f64 = texels.iter().map(square).sum();
    (0.5 * sum / texels.len() as f64).sqrt()
}

/// Integrates A and B at n·v and perceptual roughness, no narrower than the device shades.
pub fn exact(
    brdf: &'static dyn Brdf,
    masking: MaskingShadowing,
    parameters: DVec2,
    within: f64,
) -> DVec2 {
    let widths = [shaded_alpha(parameters.y); 2];
    pair(brdf, masking, parameters.x, widths, within)
}

/// A and B of a distribution and a masking of two widths.
fn pair(
    brdf: &'static dyn Brdf,
    masking: MaskingShadowing,
    n_dot_v: f64,
    widths: [f64; 2],
    within: f64,
) -> DVec2 {
    let dfg = dfg_masked_by(brdf, masking, n_dot_v, widths, within);
    DVec2::new(dfg.f0_scale, dfg.f90_scale)
}
