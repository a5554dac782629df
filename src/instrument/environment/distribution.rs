//! Importance sampling of an equirectangular map in proportion to the luminance of its *bilinear*
//! interpolation.
//!
//! docs/estimators.md ("The density of the environment") derives the density, `p_l = Y w_b / sin
//! θ`, and its guide.
//!
//! The device reads one buffer of 32-bit words ([`EnvironmentDistribution::words`]): w_b of each
//! band as f32; the cell of each slot; the slot of each cell (cells without light have none and
//! share slot 0); then a block per slot. A block has the distribution over the cell's bands, then
//! for each band the one over its columns. A distribution over n intervals is n + 1 starts in fixed
//! point, 0 to 2^32 - 1, each exact to half a unit. Cells at the right and lower edge may be
//! smaller: intervals past their end are empty.
//!
//! Sampled and stated density differ only by rounding: of the starts, at most 2^-32 of the cell's
//! light, and of a guide's sums in f32, 2^-24 of all light.

use crate::base::color;
use crate::base::glsl::constants::{CELL_COLUMNS, CELL_ROWS};
use crate::base::math::equirect;
use crate::base::pixels::{Pixels, RgbImage};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;
use std::iter;
use std::ops::Range;

/// The end of the last interval of a fixed-point distribution.
pub const FIXED_ONE: u32 = u32::MAX;

pub const CELL_COUNT: u32 = CELL_COLUMNS * CELL_ROWS;

pub const SIDE_MAX: u32 = 1 << 16;

/// Threshold of the weights, relative to the map's mean luminance over the sphere.
pub const COMPENSATION: f64 = 0.5;

/// The sampling tables of a map. The f64 twin of the device's sampling is
/// `tests/shared/environment_sampling.rs`.
#[derive(Clone, Debug)]
pub struct EnvironmentDistribution {
    /// Luminance above the threshold, by texel.
    pub weights: Pixels<f32>,
    /// w_b of each band; all 0 if no texel is above the threshold.
    pub band_weights: Vec<f64>,
    /// Columns and bands of a cell.
    pub cell_size: [u32; 2],
    /// At least one.
    pub slots: Vec<Slot>,
    /// The buffer that `shaders/lib/environment_sampling.glsl` reads.
    pub words: Vec<u32>,
}

/// A cell with light.
#[derive(Clone, Copy, Debug)]
pub struct Slot {
    pub cell: u32,
    /// Mean direction of its light.
    pub direction: DVec3,
    /// Its share of all light.
    pub mass: f64,
}

/// Returns the weight of a texel of `image` by its radiance: `max(luminance - threshold, 0)`, the
/// threshold `compensation` times the mean luminance. The device holds it in the environment's
/// alpha channel.
fn sampling_weight(image: &RgbImage, compensation: f64) -> impl Fn([f32; 3]) -> f32 {
    let threshold = compensation * mean_luminance(image);
    move |texel| (color::luminance(texel) - threshold).max(0.0) as f32
}

/// Returns the texels of level 0 on the device: radiance, and the sampling weight of
/// [`EnvironmentDistribution::new`].
pub fn weighted_texels(image: &RgbImage) -> Vec<[f32; 4]> {
    let weight = sampling_weight(image, COMPENSATION);
    image
        .data
        .iter()
        .map(|&[r, g, b]| [r, g, b, weight([r, g, b])])
        .collect()
}

impl EnvironmentDistribution {
    /// Makes the tables of `image` for sampling together with a lobe sampler. Radiance must be
    /// finite and not negative.
    pub fn new(image: &RgbImage) -> Self {
        Self::with_compensation(image, COMPENSATION)
    }

    /// As [`Self::new`], with a threshold of `compensation` times the mean luminance; 0 without a
    /// lobe sampler.
    pub fn with_compensation(image: &RgbImage, compensation: f64) -> Self {
        let width = image.width;
        let height = image.height;
        assert!(
            (1..=SIDE_MAX).contains(&width),
            "width {width} of an environment, 1 to {SIDE_MAX} expected"
        );
        assert!(
            (1..SIDE_MAX).contains(&height),
            "height {height} of an environment, 1 to {SIDE_MAX} - 1 expected"
        );
        // Rounded as on the device, so that both sample the same map.
        let weights = image.map(sampling_weight(image, compensation));
        let light = BandLight::new(&weights);
        let band_weights = light.band_weights();
        let cell_size = light.cell_size();
        let mut slots = Vec::new();
        let mut blocks = Vec::new();
        let mut slot_of_cell = vec![0; CELL_COUNT as usize];
        for index in 0..CELL_COUNT {
            let cell = light.cell(index);
            // A black map has one slot, so that every index is valid.
            if cell.mass == 0.0 && (light.total > 0.0 || index > 0) {
                continue;
            }
            slot_of_cell[index as usize] = slots.len() as u32;
            cell.write_block(cell_size, &mut blocks);
            slots.push(Slot {
                cell: index,
                direction: cell.direction([width, height]),
                mass: if light.total > 0.0 {
                    cell.mass / light.total
                } else {
                    0.0
                },
            });
        }
        let mut words: Vec<u32> = band_weights
            .iter()
            .map(|weight| (*weight as f32).to_bits())
            .collect();
        words.extend(
            (0..CELL_COUNT as usize).map(|slot| slots.get(slot).map_or(0, |slot| slot.cell)),
        );
        words.extend(slot_of_cell);
        words.extend(blocks);
        Self {
            weights,
            band_weights,
            cell_size,
            slots,
            words,
        }
    }

    /// Returns direction and mass of each slot, padded to the uniform block of
    /// `shaders/shade/reference.comp`.
    pub fn slot_texels(&self) -> Vec<[f32; 4]> {
        let texel = |slot: &Slot| slot.direction.extend(slot.mass).as_vec4().to_array();
        let mut texels: Vec<[f32; 4]> = self.slots.iter().map(texel).collect();
        texels.resize(CELL_COUNT as usize, [0.0; 4]);
        texels
    }
}

/// The light of a map by band and column.
struct BandLight<'a> {
    weights: &'a Pixels<f32>,
    /// The light of all bands.
    total: f64,
}

/// The light of the columns and bands of a cell.
struct CellLight {
    columns: Range<u32>,
    bands: Range<u32>,
    /// By band, then by column.
    light: Vec<Vec<f64>>,
    /// By band.
    band_masses: Vec<f64>,
    mass: f64,
}

impl<'a> BandLight<'a> {
    fn new(weights: &'a Pixels<f32>) -> Self {
        let mut light = Self {
            weights,
            total: 0.0,
        };
        light.total = (0..light.band_count() as usize)
            .map(|band| {
                (0..weights.width)
                    .map(|column| light.between(band, column))
                    .sum::<f64>()
            })
            .sum();
        light
    }

    fn band_count(&self) -> u32 {
        self.weights.height + 1
    }

    /// Columns and bands of a cell.
    fn cell_size(&self) -> [u32; 2] {
        [
            self.weights.width.div_ceil(CELL_COLUMNS),
            self.band_count().div_ceil(CELL_ROWS),
        ]
    }

    /// Returns the light between a column and the next in a band, from the four texels around it.
    fn between(&self, band: usize, column: u32) -> f64 {
        let Pixels { width, height, .. } = *self.weights;
        let [above, below] = rows_of_band(band, height);
        let [top, bottom] = band_limits(band, height);
        let right = (column + 1) % width;
        let weight = |x, y| f64::from(self.weights.get(x, y));
        let mean = (weight(column, above)
            + weight(right, above)
            + weight(column, below)
            + weight(right, below))
            / 4.0;
        mean / f64::from(width) * (bottom - top) * mean_sine(band, height)
    }

    /// Returns w_b of each band; all 0 without light.
    fn band_weights(&self) -> Vec<f64> {
        (0..self.band_count() as usize)
            .map(|band| {
                if self.total > 0.0 {
                    mean_sine(band, self.weights.height) / (2.0 * PI * PI * self.total)
                } else {
                    0.0
                }
            })
            .collect()
    }

    fn cell(&self, index: u32) -> CellLight {
        let size = [self.weights.width, self.band_count()];
        let [columns, bands] = cell_range(index, self.cell_size(), size);
        let band_light = |band: u32| -> Vec<f64> {
            columns
                .clone()
                .map(|column| self.between(band as usize, column))
                .collect()
        };
        let light: Vec<Vec<f64>> = bands.clone().map(band_light).collect();
        let band_masses: Vec<f64> = light.iter().map(|band| band.iter().sum()).collect();
        CellLight {
            columns,
            bands,
            light,
            mass: band_masses.iter().sum(),
            band_masses,
        }
    }
}

impl CellLight {
    /// Appends the cell's block of distributions.
    fn write_block(&self, [columns, bands]: [u32; 2], blocks: &mut Vec<u32>) {
        write_distribution(&self.band_masses, bands, blocks);
        for row in 0..bands as usize {
            let light = self.light.get(row).map_or(&[][..], Vec::as_slice);
            write_distribution(light, columns, blocks);
        }
    }

    /// Returns the mean direction of the light in a map of `width` x `height` texels.
    fn direction(&self, [width, height]: [u32; 2]) -> DVec3 {
        let texels = self
            .bands
            .clone()
            .zip(&self.light)
            .flat_map(|(band, light)| {
                self.columns
                    .clone()
                    .zip(light)
                    .map(move |(column, light)| (band, column, *light))
            });
        let moment: DVec3 = texels
            .map(|(band, column, light)| {
                let [top, bottom] = band_limits(band as usize, height);
                let uv = DVec2::new(
                    (f64::from(column) + 1.0) / f64::from(width),
                    0.5 * (top + bottom),
                );
                light * equirect::direction_from_uv(uv)
            })
            .sum();
        // The light of a cell that spans the sphere may have no mean direction; any will do.
        moment.try_normalize().unwrap_or(DVec3::Y)
    }
}

/// Returns the mean luminance over the sphere, each texel by its solid angle.
fn mean_luminance(image: &RgbImage) -> f64 {
    let row_mean = |row: u32| {
        let texels = &image.data[row as usize * image.width as usize..][..image.width as usize];
        let solid_angle = equirect::texel_solid_angle(row, image.width, image.height);
        solid_angle * texels.iter().copied().map(color::luminance).sum::<f64>()
    };
    (0..image.height).map(row_mean).sum::<f64>() / (4.0 * PI)
}

/// Returns the texel rows whose centres bound a band.
pub fn rows_of_band(band: usize, height: u32) -> [u32; 2] {
    let band = band as u32;
    [band.saturating_sub(1), band.min(height - 1)]
}

/// Returns v at the upper and the lower edge of a band.
pub fn band_limits(band: usize, height: u32) -> [f64; 2] {
    let band = band as f64;
    let height = f64::from(height);
    [
        (band - 0.5).max(0.0) / height,
        (band + 0.5).min(height) / height,
    ]
}

fn mean_sine(band: usize, height: u32) -> f64 {
    let [top, bottom] = band_limits(band, height).map(|v| v * PI);
    // The difference of the cosines as a product, which does not cancel near the poles.
    2.0 * (0.5 * (top + bottom)).sin() * (0.5 * (bottom - top)).sin() / (bottom - top)
}

/// Returns columns and bands of a cell; none past the edges of the map.
fn cell_range(
    cell: u32,
    [cell_width, cell_height]: [u32; 2],
    [width, band_count]: [u32; 2],
) -> [Range<u32>; 2] {
    let range = |index: u32, size: u32, count: u32| {
        (index * size).min(count)..((index + 1) * size).min(count)
    };
    [
        range(cell % CELL_COLUMNS, cell_width, width),
        range(cell / CELL_COLUMNS, cell_height, band_count),
    ]
}

/// Appends the distribution over `count` intervals; those beyond `masses` are empty. Masses that
/// are all 0 are equal.
fn write_distribution(masses: &[f64], count: u32, words: &mut Vec<u32>) {
    let total: f64 = masses.iter().sum();
    let mut below = 0.0;
    for (interval, mass) in masses.iter().enumerate() {
        let share = if total > 0.0 {
            below / total
        } else {
            interval as f64 / masses.len() as f64
        };
        words.push((share * f64::from(FIXED_ONE)).round() as u32);
        below += mass;
    }
    words.extend(iter::repeat_n(FIXED_ONE, count as usize + 1 - masses.len()));
}
