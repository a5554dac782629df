//! The f64 twin of `shaders/lib/environment_sampling.glsl`, on the tables that the device reads.
#![allow(dead_code, reason = "each test program uses a part")]

use glam::{DVec2, DVec3};
use splitsum::base::glsl::constants::{CELL_COLUMNS, ENVIRONMENT_SIN_THETA_MIN};
use splitsum::base::math::equirect;
use splitsum::base::pixels::RgbImage;
use splitsum::instrument::environment::distribution::{
    CELL_COUNT, COMPENSATION, EnvironmentDistribution, FIXED_ONE, Slot, band_limits, rows_of_band,
};

pub struct Sampling {
    pub tables: EnvironmentDistribution,
    /// The guide with weight 1 everywhere.
    even: Guide,
}

/// Weights of the cells; see the module's documentation.
pub struct Guide {
    /// g of each slot.
    weights: Vec<f64>,
    /// Sum of mass times weight up to and including each slot.
    ends: Vec<f64>,
}

/// Weights of four neighbouring texel centres at (s, t) = (0, 0), (1, 0), (0, 1), (1, 1).
struct Quad {
    corners: [f64; 4],
}

impl Sampling {
    pub fn new(image: &RgbImage) -> Self {
        Self::with_compensation(image, COMPENSATION)
    }

    pub fn with_compensation(image: &RgbImage, compensation: f64) -> Self {
        let tables = EnvironmentDistribution::with_compensation(image, compensation);
        let even = Guide::new(&tables.slots, |_| 1.0);
        Self { tables, even }
    }

    pub fn guide(&self, weight: impl Fn(DVec3) -> f64) -> Guide {
        Guide::new(&self.tables.slots, weight)
    }

    /// Returns the density (1/sr) with which [`Self::sample`] returns the unit direction `d`
    /// (environment's frame).
    pub fn pdf(&self, d: DVec3) -> f64 {
        self.guided_pdf(&self.even, d)
    }

    pub fn guided_pdf(&self, guide: &Guide, d: DVec3) -> f64 {
        let (width, height) = (self.tables.weights.width, self.tables.weights.height);
        let uv = equirect::uv_from_direction(d);
        let texel = uv * DVec2::new(f64::from(width), f64::from(height)) - 0.5;
        let corner = texel.floor();
        let column = (corner.x as i64).rem_euclid(i64::from(width)) as u32;
        let band = (corner.y as i64 + 1).clamp(0, i64::from(height)) as u32;
        let [cell_width, cell_height] = self.tables.cell_size;
        let cell = band / cell_height * CELL_COLUMNS + column / cell_width;
        let slot = self.tables.words[self.tables.band_weights.len() + (CELL_COUNT + cell) as usize]
            as usize;
        let band = band as usize;
        self.density(self.quad(band, column).weight(texel - corner), band, d) * guide.factor(slot)
    }

    /// Returns a unit direction from `xi` in [0, 1)² and its density (1/sr): y selects cell and
    /// band, x the column.
    pub fn sample(&self, xi: DVec2) -> (DVec3, f64) {
        self.guided_sample(&self.even, xi)
    }

    pub fn guided_sample(&self, guide: &Guide, xi: DVec2) -> (DVec3, f64) {
        let (width, height) = (self.tables.weights.width, self.tables.weights.height);
        let (slot, fraction) = guide.invert(xi.y);
        let [cell_width, cell_height] = self.tables.cell_size.map(|side| side as usize);
        let block_len = (cell_height + 1) + cell_height * (cell_width + 1);
        let blocks = &self.tables.words[self.tables.band_weights.len() + 2 * CELL_COUNT as usize..];
        let (bands, columns) = blocks[slot * block_len..][..block_len].split_at(cell_height + 1);
        let (row, down) = invert(bands, fraction);
        let (column, right) = invert(&columns[row * (cell_width + 1)..][..=cell_width], xi.x);
        let cell = self.tables.slots[slot].cell as usize;
        let band = cell / CELL_COLUMNS as usize * cell_height + row;
        let column = cell % CELL_COLUMNS as usize * cell_width + column;

        let quad = self.quad(band, column as u32);
        let inner = quad.invert(DVec2::new(right, down));
        let [top, bottom] = band_limits(band, height);
        let u = (column as f64 + 0.5 + inner.x) / f64::from(width);
        let v = top + (bottom - top) * inner.y;
        let d = equirect::direction_from_uv(DVec2::new(u, v));
        (
            d,
            self.density(quad.weight(inner), band, d) * guide.factor(slot),
        )
    }

    fn density(&self, weight: f64, band: usize, d: DVec3) -> f64 {
        weight * self.tables.band_weights[band]
            / d.x.hypot(d.z).max(f64::from(ENVIRONMENT_SIN_THETA_MIN))
    }

    fn quad(&self, band: usize, column: u32) -> Quad {
        let [above, below] = rows_of_band(band, self.tables.weights.height);
        let right = (column + 1) % self.tables.weights.width;
        let at = |x, y| f64::from(self.tables.weights.get(x, y));
        Quad {
            corners: [
                at(column, above),
                at(right, above),
                at(column, below),
                at(right, below),
            ],
        }
    }
}

impl Guide {
    fn new(slots: &[Slot], weight: impl Fn(DVec3) -> f64) -> Self {
        let weights: Vec<f64> = slots.iter().map(|slot| weight(slot.direction)).collect();
        let mut sum = 0.0;
        let mut end = |(slot, weight): (&Slot, &f64)| {
            sum += slot.mass * weight;
            sum
        };
        Self {
            ends: slots.iter().zip(&weights).map(&mut end).collect(),
            weights,
        }
    }

    fn sum(&self) -> f64 {
        *self
            .ends
            .last()
            .expect("a distribution has at least one slot")
    }

    /// Returns the ratio of guided to plain density in a slot's cell.
    fn factor(&self, slot: usize) -> f64 {
        if self.sum() > 0.0 {
            self.weights[slot] / self.sum()
        } else {
            0.0
        }
    }

    /// Returns the slot of `xi` in [0, 1), and the position inside it, in [0, 1].
    fn invert(&self, xi: f64) -> (usize, f64) {
        let place = xi * self.sum();
        let slot = self
            .ends
            .partition_point(|end| *end <= place)
            .min(self.ends.len() - 1);
        let start = if slot > 0 { self.ends[slot - 1] } else { 0.0 };
        let size = self.ends[slot] - start;
        (
            slot,
            if size > 0.0 {
                ((place - start) / size).clamp(0.0, 1.0)
            } else {
                0.0
            },
        )
    }
}

impl Quad {
    fn weight(&self, place: DVec2) -> f64 {
        let [y00, y10, y01, y11] = self.corners;
        let lerp = |a: f64, b: f64, x: f64| a * (1.0 - x) + b * x;
        lerp(lerp(y00, y10, place.x), lerp(y01, y11, place.x), place.y)
    }

    /// Samples a position with density proportional to the weight, from uniform `xi`.
    fn invert(&self, xi: DVec2) -> DVec2 {
        let [y00, y10, y01, y11] = self.corners;
        let t = invert_linear(y00 + y10, y01 + y11, xi.y);
        let s = invert_linear(y00 * (1.0 - t) + y01 * t, y10 * (1.0 - t) + y11 * t, xi.x);
        DVec2::new(s, t)
    }
}

/// Returns the interval of a distribution that holds `xi` in [0, 1], and the position inside it, in
/// [0, 1].
fn invert(starts: &[u32], xi: f64) -> (usize, f64) {
    let position = xi * f64::from(FIXED_ONE);
    // The end of the last interval belongs to none.
    let fixed = (position as u32).min(FIXED_ONE - 1);
    let interval = starts.partition_point(|start| *start <= fixed) - 1;
    let (start, end) = (f64::from(starts[interval]), f64::from(starts[interval + 1]));
    (
        interval,
        ((position - start) / (end - start)).clamp(0.0, 1.0),
    )
}

/// Inverts the distribution of x in [0, 1] whose density is linear from `p0` at 0 to `p1` at 1
/// (each ≥ 0, any scale).
fn invert_linear(p0: f64, p1: f64, xi: f64) -> f64 {
    let total = p0 + p1;
    // No light at either end: any position will do. 0 maps to 0, even if the root would be 0/0.
    if total <= 0.0 || xi <= 0.0 {
        return xi;
    }
    let (q0, q1) = (p0 / total, p1 / total);
    xi / (q0 + (q0 * q0 * (1.0 - xi) + q1 * q1 * xi).sqrt())
}
