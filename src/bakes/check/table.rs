//! The score of a DFG table, and which conventions would fit it better.

use crate::bakes::convention::{Convention, TABLE_AXES, TABLE_CHANNELS, TableAxes, TableChannels};
use crate::brdf::{Brdf, MaskingShadowing, alpha_from_perceptual_roughness};
use crate::pixels::RgbImage;
use crate::precompute::dfg::reference::dfg;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Rows and columns of a table that are compared, about; the outermost are among them.
const LINES: u32 = 32;
/// The same for a search of conventions.
const SEARCHED: u32 = 9;

/// How wrong a table is.
#[derive(Clone, Debug)]
pub struct TableScore {
    /// Largest error of A or B at the texels that were compared.
    pub max_error: f64,
    pub rms: f64,
    /// n·v and perceptual roughness of the largest.
    pub worst: DVec2,
    /// Texels that were compared.
    pub count: usize,
    pub verdict: String,
}

/// Error of a table that is as its integral: what 8 bits round to.
const GOOD: f64 = 1.0 / 255.0;

/// Scores a table against the integrals in f64 at texel centres.
pub fn score(table: &RgbImage, brdf: &'static dyn Brdf, convention: &Convention) -> TableScore {
    let Convention { table_axes, table_channels, masking, .. } = convention;
    let places = places(table, LINES);
    let errors: Vec<(DVec2, f64, f64)> = places
        .par_iter()
        .map(|place| {
            let at = table_axes.parameters(place.uv);
            let d = (table_channels.pair)(place.texel) - exact(brdf, *masking, at);
            (at, d.abs().max_element(), 0.5 * d.length_squared())
        })
        .collect();
    let (worst, max_error, _) =
        errors.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((DVec2::ZERO, 0.0, 0.0));
    let rms = (errors.iter().map(|(_, _, square)| square).sum::<f64>() / errors.len() as f64).sqrt();
    let verdict = if max_error <= GOOD {
        "good: within what 8 bits round to".to_owned()
    } else {
        let best = search(table, brdf).into_iter().next();
        let is_own = |found: &Fitting| {
            found.axes.name == table_axes.name && found.channels.name == table_channels.name && found.masking.1 == *masking
        };
        match best {
            Some(found) if !is_own(&found) && found.rms < 0.5 * rms => format!(
                "--table-axes {} --table-channels {} --masking {} fit better: rms {:.1e}",
                found.axes.name, found.channels.name, found.masking.0, found.rms
            ),
            _ => "differs, and no other convention fits better".to_owned(),
        }
    };
    TableScore { max_error, rms, worst, count: errors.len(), verdict }
}

/// Conventions of a table and what they leave.
pub struct Fitting {
    pub axes: &'static TableAxes,
    pub channels: &'static TableChannels,
    pub masking: (&'static str, MaskingShadowing),
    pub rms: f64,
}

/// Every way to read a table, best first.
pub fn search(table: &RgbImage, brdf: &'static dyn Brdf) -> Vec<Fitting> {
    let places = places(table, SEARCHED);
    let ways: Vec<_> =
        TABLE_AXES.iter().flat_map(|axes| MaskingShadowing::ALL.iter().map(move |masking| (axes, *masking))).collect();
    let fit = |(axes, masking): &(&'static TableAxes, (&'static str, MaskingShadowing))| {
        let exact: Vec<DVec2> = places.iter().map(|place| exact(brdf, masking.1, axes.parameters(place.uv))).collect();
        let with = |channels: &'static TableChannels| {
            let square = |(place, exact): (&Place, &DVec2)| ((channels.pair)(place.texel) - exact).length_squared();
            let sum: f64 = places.iter().zip(&exact).map(square).sum();
            Fitting { axes, channels, masking: *masking, rms: (0.5 * sum / places.len() as f64).sqrt() }
        };
        TABLE_CHANNELS.iter().map(with).collect::<Vec<_>>()
    };
    let mut fits: Vec<Fitting> = ways.par_iter().flat_map_iter(fit).collect();
    fits.sort_by(|a, b| a.rms.total_cmp(&b.rms));
    fits
}

struct Place {
    uv: DVec2,
    texel: DVec2,
}

/// About `lines` x `lines` texels, evenly, with the edges.
fn places(table: &RgbImage, lines: u32) -> Vec<Place> {
    let pick = |side: u32| -> Vec<u32> {
        let count = side.min(lines);
        (0..count).map(|k| if count == 1 { 0 } else { k * (side - 1) / (count - 1) }).collect()
    };
    let columns = pick(table.width);
    let size = DVec2::new(table.width.into(), table.height.into());
    let place = |x: u32, y: u32| {
        let texel = DVec3::from_array(table.get(x, y).map(f64::from));
        Place { uv: (DVec2::new(x.into(), y.into()) + 0.5) / size, texel: texel.truncate() }
    };
    pick(table.height).into_iter().flat_map(|y| columns.iter().map(move |x| (*x, y))).map(|(x, y)| place(x, y)).collect()
}

/// A and B at n·v and perceptual roughness.
fn exact(brdf: &'static dyn Brdf, masking: MaskingShadowing, at: DVec2) -> DVec2 {
    let found = dfg(brdf, masking, at.x, alpha_from_perceptual_roughness(at.y));
    DVec2::new(found.f0_scale, found.f90_scale)
}
