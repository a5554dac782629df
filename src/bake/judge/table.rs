//! The score of a DFG table, and the conventions that fit it best.

use super::Cause;
use crate::bake::convention::{Convention, TABLE_AXES, TABLE_CHANNELS, TableAxes, TableChannels};
use crate::base::color::{srgb_curve, srgb_decode};
use crate::base::glsl::constants::ALPHA_MIN;
use crate::base::names::Listed;
use crate::base::pixels::RgbImage;
use crate::instrument::brdf::{Brdf, MaskingShadowing, alpha_from_perceptual_roughness};
use crate::instrument::precompute::dfg::reference::{dfg_by, dfg_masked_by};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// Approximate number of compared rows and columns, edges included.
const LINES: u32 = 17;
/// Root mean square error of a table that is something else.
const NOISE: f64 = 0.15;
/// Largest root mean square error of a convention that fits: as much as masking makes.
const FITS: f64 = 0.02;
/// Number of further texels that stand out.
const ODD_COUNT: usize = 16;
/// Number of rows and columns in a search of conventions.
const SEARCHED: u32 = 7;

#[derive(Clone, Debug)]
pub struct TableScore {
    /// Largest error of A or B.
    pub max_error: f64,
    /// Root mean square error of A and B.
    pub rms: f64,
    /// n·v and perceptual roughness of the largest error.
    pub worst: DVec2,
    pub count: usize,
    /// What the verdict names; empty if the table is good.
    pub causes: Vec<Cause>,
    pub verdict: String,
}

/// Relative error of the integrals in a score and in a search.
const SCORED_WITHIN: f64 = 1e-5;
const SEARCHED_WITHIN: f64 = 1e-3;

/// Narrowest lobe that is integrated.
const NARROWEST: f64 = 1e-6;

/// Below this n·v the mean of few samples errs most.
const GRAZING: f64 = 0.5;

/// Largest error of a good table: a step of 8 bits.
const GOOD: f64 = 1.0 / 255.0;

/// Returns n·v and roughness of compared texels, the larger error, and the mean square error of A
/// and B.
fn deviations(
    table: &RgbImage,
    brdf: &'static dyn Brdf,
    (axes, channels, masking): (&TableAxes, &TableChannels, MaskingShadowing),
) -> Vec<(DVec2, f64, f64)> {
    let mut places = places(table, LINES);
    places.extend(odd_places(table));
    let deviation = |place: &Place| {
        let at = axes.parameters(place.uv);
        let found = (channels.pair)(place.texel);
        let d = found - exact(brdf, masking, at, SCORED_WITHIN);
        // Programs clamp narrow lobes at different widths, or not at all.
        let narrow = alpha_from_perceptual_roughness(at.y);
        let widths = [narrow.max(NARROWEST); 2];
        let unclamped = (narrow < width(at.y))
            .then(|| found - pair(brdf, masking, at.x, widths, SCORED_WITHIN));
        let d = unclamped
            .filter(|other| other.abs().max_element() < d.abs().max_element())
            .unwrap_or(d);
        (at, d.abs().max_element(), 0.5 * d.length_squared())
    };
    places.par_iter().map(deviation).collect()
}

fn root_mean(errors: &[(DVec2, f64, f64)]) -> f64 {
    (errors.iter().map(|(_, _, square)| square).sum::<f64>() / errors.len() as f64).sqrt()
}

/// Scores a table against integrals in f64 at texel centres.
pub fn score(table: &RgbImage, brdf: &'static dyn Brdf, convention: &Convention) -> TableScore {
    let Convention {
        table_axes,
        table_channels,
        masking,
        ..
    } = convention;
    let errors = deviations(table, brdf, (table_axes, table_channels, *masking));
    let (worst, max_error, _) = errors
        .iter()
        .copied()
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap_or((DVec2::ZERO, 0.0, 0.0));
    let rms = root_mean(&errors);
    let is_good_beyond = errors
        .iter()
        .all(|(at, error, _)| at.x < GRAZING || *error <= GOOD);
    let cause =
        (max_error > GOOD).then(
            || match explained(table, brdf, convention, [rms, max_error]) {
                Cause {
                    kind: "unknown", ..
                } if is_good_beyond => {
                    let words = format!(
                        "too few samples: beyond n·v {GRAZING} it is within a step of 8 bits"
                    );
                    Cause {
                        kind: "noise",
                        words,
                    }
                }
                cause => cause,
            },
        );
    let verdict = cause
        .as_ref()
        .map_or("good: below 1/255, a step of 8 bits", |cause| &cause.words)
        .to_owned();
    TableScore {
        max_error,
        rms,
        worst,
        count: errors.len(),
        causes: cause.into_iter().collect(),
        verdict,
    }
}

fn explained(
    table: &RgbImage,
    brdf: &'static dyn Brdf,
    convention: &Convention,
    [rms, max_error]: [f64; 2],
) -> Cause {
    let Convention {
        table_axes,
        table_channels,
        masking,
        ..
    } = convention;
    let found = search(table, brdf).swap_remove(0);
    let flags = [
        ("--table-axes", found.axes.name, table_axes.name),
        ("--table-channels", found.channels.name, table_channels.name),
        ("--masking", found.masking.name(), masking.name()),
    ];
    let others = |flags: &[(&str, &str, &str)]| -> String {
        flags
            .iter()
            .filter(|(_, found, own)| found != own)
            .map(|(flag, found, _)| format!(" {flag} {found}"))
            .collect()
    };
    let other = others(&flags);
    if !other.is_empty() && found.rms < (0.5 * rms).min(FITS) {
        let left = root_mean(&deviations(
            table,
            brdf,
            (found.axes, found.channels, found.masking),
        ));
        return Cause {
            kind: "convention",
            words: format!("fits{other}; rms {left:.1e} if fixed"),
        };
    }
    let places = places(table, SEARCHED);
    let texel = DVec2::new(1.0 / f64::from(table.width), 1.0 / f64::from(table.height));
    // A table sampled at texel corners is shifted by up to a texel, or stretched.
    let (axes, none) = ([DVec2::X, DVec2::Y, DVec2::ONE], DVec2::ZERO);
    let shifts = axes
        .iter()
        .flat_map(|axis| [-1.0, -0.5, 0.5, 1.0].map(|side| (None, *axis * side, none)));
    let readings = shifts.chain(axes.map(|axis| (None, none, axis)));
    let readings: Vec<Read> = readings
        .chain(READINGS.iter().map(|reading| (Some(reading), none, none)))
        .collect();
    let rms_by = |axes: &TableAxes, channels: &TableChannels, (reading, shift, stretch): &Read| {
        let square = |place: &Place| {
            let stretched = (place.uv - 0.5) * (1.0 + *stretch * texel / (1.0 - texel));
            let at = axes
                .parameters(0.5 + stretched + *shift * texel)
                .clamp(DVec2::splat(1e-3), DVec2::ONE);
            let (at, texel) = reading.map_or((at, place.texel), |(.., read)| read(at, place.texel));
            ((channels.pair)(texel) - exact(brdf, *masking, at, SEARCHED_WITHIN)).length_squared()
        };
        (0.5 * places.iter().map(square).sum::<f64>() / places.len() as f64).sqrt()
    };
    let own = rms_by(table_axes, table_channels, &(None, none, none));
    let all: Vec<f64> = readings
        .par_iter()
        .map(|read| rms_by(table_axes, table_channels, read))
        .collect();
    let best = (0..all.len())
        .min_by(|a, b| all[*a].total_cmp(&all[*b]))
        .expect("readings");
    let most = places
        .iter()
        .map(|place| place.texel.max_element())
        .fold(0.0, f64::max);
    let by_integral = |(_, other, of_masking, facet): &Integral| {
        let square = |place: &Place| {
            let at = table_axes
                .parameters(place.uv)
                .clamp(DVec2::splat(1e-3), DVec2::ONE);
            let (widths, masking) = ([width(at.y), of_masking(at.y)], other.unwrap_or(*masking));
            let facet = |v_dot_h, n_dot_h| facet(v_dot_h, n_dot_h, at.x);
            let found = dfg_by(brdf, masking, at.x, widths, SEARCHED_WITHIN, facet);
            // Other integrals may exceed 1, where an image of integers is cut.
            let cut = DVec2::new(found.f0_scale, found.f90_scale).min(DVec2::splat(most));
            ((table_channels.pair)(place.texel) - cut).length_squared()
        };
        (0.5 * places.iter().map(square).sum::<f64>() / places.len() as f64).sqrt()
    };
    let integrals: Vec<f64> = INTEGRALS.par_iter().map(by_integral).collect();
    let least = (0..integrals.len())
        .min_by(|a, b| integrals[*a].total_cmp(&integrals[*b]))
        .expect("integrals");
    if integrals[least] < (0.5 * own.min(all[best])).min(FITS) {
        return Cause {
            kind: "integral",
            words: INTEGRALS[least].0.to_owned(),
        };
    }
    if all[best] < 0.5 * own {
        let share = 100.0 * (all[best] / own);
        let (reading, shift, stretch) = readings[best];
        let moved = || {
            (
                "shift",
                if stretch == none {
                    shifted(shift)
                } else {
                    stretched(stretch)
                },
            )
        };
        let (kind, words) =
            reading.map_or_else(moved, |(kind, words, _)| (*kind, (*words).to_owned()));
        return Cause {
            kind,
            words: format!("{words}; fixing it leaves {share:.0} % of the rms"),
        };
    }
    let by_found = READINGS.iter().map(|reading| {
        (
            rms_by(found.axes, found.channels, &(Some(reading), none, none)),
            reading,
        )
    });
    let (left, (kind, words, _)) = by_found
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .expect("readings");
    if left < FITS {
        return Cause {
            kind,
            words: format!("fits{}; {words}", others(&flags[..2])),
        };
    }
    let words = if rms > NOISE {
        "no convention fits: not a DFG table of this model, or encoded".to_owned()
    } else {
        format!(
            "no other convention fits better; the largest error is {:.1} steps of 8 bits",
            255.0 * max_error
        )
    };
    Cause {
        kind: "unknown",
        words,
    }
}

/// A reading, a shift in texels, and the axes along which nodes reach the edges.
type Read = (Option<&'static Reading>, DVec2, DVec2);

/// Another meaning of a table: how to read the parameters of a place and its texel.
type Reading = (
    &'static str,
    &'static str,
    fn(DVec2, DVec2) -> (DVec2, DVec2),
);
static READINGS: &[Reading] = &[
    (
        "encoding",
        "encoded with gamma 2.2: decode it",
        |at, texel| (at, texel.powf(2.2)),
    ),
    ("encoding", "encoded as sRGB: decode it", |at, texel| {
        (at, texel.map(|x| srgb_decode(x as f32).into()))
    }),
    (
        "encoding",
        "decoded with gamma 2.2 though linear",
        |at, texel| (at, texel.powf(1.0 / 2.2)),
    ),
    ("encoding", "decoded as sRGB though linear", |at, texel| {
        (at, texel.map(srgb_curve))
    }),
    (
        "axis",
        "spaced by alpha; expected perceptual roughness",
        |at, texel| (DVec2::new(at.x, at.y.sqrt()), texel),
    ),
    ("axis", "spaced by the root of roughness", |at, texel| {
        (DVec2::new(at.x, at.y * at.y), texel)
    }),
    ("axis", "spaced by the root of n·v", |at, texel| {
        (DVec2::new(at.x * at.x, at.y), texel)
    }),
];

/// Another integral: its masking, if it is not the expected one, the masking's width by roughness,
/// and the factor and cosine of [`dfg_by`], by v·h, n·h and n·v.
type Integral = (
    &'static str,
    Option<MaskingShadowing>,
    fn(f64) -> f64,
    fn(f64, f64, f64) -> [f64; 2],
);
const SCHLICK: Option<MaskingShadowing> = Some(MaskingShadowing::Schlick);
/// Schlick's k is half of the masking's width.
static INTEGRALS: &[Integral] = &[
    (
        "Schlick's masking of direct light, k = (r + 1)^2/8; expected k = alpha/2",
        SCHLICK,
        |r| (r + 1.0).powi(2) / 4.0,
        USUAL,
    ),
    (
        "Schlick's masking of k = alpha^2/2; expected k = alpha/2",
        SCHLICK,
        |r| r.powi(4),
        USUAL,
    ),
    (
        "Schlick's masking of k = alpha; expected k = alpha/2",
        SCHLICK,
        |r| 2.0 * r * r,
        USUAL,
    ),
    (
        "Schlick's masking of k = r/2; expected k = alpha/2",
        SCHLICK,
        |r| r,
        USUAL,
    ),
    ("masking by roughness; expected alpha", None, |r| r, USUAL),
    (
        "masking by alpha squared; expected alpha",
        None,
        |r| r.powi(4),
        USUAL,
    ),
    (
        "Fresnel of n·h; expected v·h",
        None,
        width,
        |v_dot_h, n_dot_h, _| [v_dot_h, n_dot_h],
    ),
    (
        "Fresnel of n·v; expected v·h",
        None,
        width,
        |v_dot_h, _, n_dot_v| [v_dot_h, n_dot_v],
    ),
    (
        "samples without the factor v·h of their weight",
        None,
        width,
        |v_dot_h, _, _| [1.0, v_dot_h],
    ),
    (
        "samples without the divisor n·h of their weight",
        None,
        width,
        |v_dot_h, n_dot_h, _| [v_dot_h * n_dot_h, v_dot_h],
    ),
];
const USUAL: fn(f64, f64, f64) -> [f64; 2] = |v_dot_h, _, _| [v_dot_h; 2];

fn shifted(shift: DVec2) -> String {
    let along = [
        (shift.x, ["far right", "far left"]),
        (shift.y, ["low", "high"]),
    ];
    let sides = along
        .iter()
        .filter(|(far, _)| *far != 0.0)
        .map(|(far, sides)| sides[usize::from(*far > 0.0)]);
    format!(
        "its values are {} texel too {}",
        shift.abs().max_element(),
        sides.collect::<Vec<_>>().join(" and too ")
    )
}

fn stretched(axis: DVec2) -> String {
    let lines = if axis == DVec2::ONE {
        "texels"
    } else if axis.x > 0.0 {
        "columns"
    } else {
        "rows"
    };
    format!("its {lines} are at i/(n - 1), from edge to edge; expected centres, (i + 0.5)/n")
}

pub struct Fitting {
    pub axes: &'static TableAxes,
    pub channels: &'static TableChannels,
    pub masking: MaskingShadowing,
    pub rms: f64,
}

/// Tries every way to read a table, best first.
pub fn search(table: &RgbImage, brdf: &'static dyn Brdf) -> Vec<Fitting> {
    let places = places(table, SEARCHED);
    // The eight ways of axes share parameters, so each is integrated once.
    let key = |at: DVec2| [at.x.to_bits(), at.y.to_bits()];
    let round = |at: DVec2| (at * 65536.0).round() / 65536.0;
    let at = |axes: &TableAxes, place: &Place| round(axes.parameters(place.uv));
    let mut wanted: Vec<DVec2> = TABLE_AXES
        .iter()
        .flat_map(|axes| places.iter().map(move |place| at(axes, place)))
        .collect();
    wanted.sort_by_key(|at| key(*at));
    wanted.dedup();
    let table_of = |masking: MaskingShadowing| -> HashMap<[u64; 2], DVec2> {
        wanted
            .par_iter()
            .map(|at| (key(*at), exact(brdf, masking, *at, SEARCHED_WITHIN)))
            .collect()
    };
    let fits_of = |masking: &MaskingShadowing| {
        let known = table_of(*masking);
        let fit = |axes: &'static TableAxes, channels: &'static TableChannels| {
            let square = |place: &Place| {
                ((channels.pair)(place.texel) - known[&key(at(axes, place))]).length_squared()
            };
            let sum: f64 = places.iter().map(square).sum();
            Fitting {
                axes,
                channels,
                masking: *masking,
                rms: (0.5 * sum / places.len() as f64).sqrt(),
            }
        };
        let pairs = TABLE_AXES
            .iter()
            .flat_map(|axes| TABLE_CHANNELS.iter().map(move |channels| (axes, channels)));
        pairs
            .map(|(axes, channels)| fit(axes, channels))
            .collect::<Vec<_>>()
    };
    let mut fits: Vec<Fitting> = MaskingShadowing::all().flat_map(fits_of).collect();
    fits.sort_by(|a, b| a.rms.total_cmp(&b.rms));
    fits
}

struct Place {
    uv: DVec2,
    texel: DVec2,
}

fn place(table: &RgbImage, [x, y]: [u32; 2]) -> Place {
    let size = DVec2::new(table.width.into(), table.height.into());
    let texel = DVec3::from_array(table.get(x, y).map(f64::from)).truncate();
    Place {
        uv: (DVec2::new(x.into(), y.into()) + 0.5) / size,
        texel,
    }
}

/// Picks the texels that differ most from the mean of their neighbours: a row or a texel that is
/// wrong by itself.
fn odd_places(table: &RgbImage) -> Vec<Place> {
    let texel = |x: u32, y: u32| place(table, [x, y]).texel;
    let sides = |at: u32, last: u32| [at.saturating_sub(1), (at + 1).min(last)];
    let off = |i: u32| {
        let (x, y) = (i % table.width, i / table.width);
        let beside: DVec2 = sides(x, table.width - 1).map(|x| texel(x, y)).iter().sum();
        let below: DVec2 = sides(y, table.height - 1).map(|y| texel(x, y)).iter().sum();
        (texel(x, y) - (beside + below) / 4.0).abs().max_element()
    };
    let mut ranked: Vec<(f64, u32)> = (0..table.width * table.height)
        .map(|i| (off(i), i))
        .collect();
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    ranked
        .iter()
        .take(ODD_COUNT)
        .map(|(_, i)| place(table, [i % table.width, i / table.width]))
        .collect()
}

/// Picks about `lines` x `lines` texels, evenly, edges included.
fn places(table: &RgbImage, lines: u32) -> Vec<Place> {
    let pick = |side: u32| -> Vec<u32> {
        let count = side.min(lines);
        (0..count)
            .map(|k| {
                if count == 1 {
                    0
                } else {
                    k * (side - 1) / (count - 1)
                }
            })
            .collect()
    };
    let columns = pick(table.width);
    pick(table.height)
        .iter()
        .flat_map(|y| columns.iter().map(|x| place(table, [*x, *y])))
        .collect()
}

/// Returns the width of a perceptual roughness, no narrower than the device shades.
fn width(roughness: f64) -> f64 {
    alpha_from_perceptual_roughness(roughness).max(ALPHA_MIN.into())
}

/// Integrates A and B at n·v and perceptual roughness, no narrower than the device shades.
pub fn exact(brdf: &'static dyn Brdf, masking: MaskingShadowing, at: DVec2, within: f64) -> DVec2 {
    pair(brdf, masking, at.x, [width(at.y); 2], within)
}

/// A and B of a distribution and a masking of two widths.
fn pair(
    brdf: &'static dyn Brdf,
    masking: MaskingShadowing,
    n_dot_v: f64,
    widths: [f64; 2],
    within: f64,
) -> DVec2 {
    let found = dfg_masked_by(brdf, masking, n_dot_v, widths, within);
    DVec2::new(found.f0_scale, found.f90_scale)
}
