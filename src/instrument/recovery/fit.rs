//! The fit of roughness and F0.
//!
//! With Schlick's Fresnel each value of an image is a line in F0, so two images give all. Between
//! two widths values are interpolated linearly. For each width of the grid the best F0 is known in
//! closed form, or by Brent's method if the loss has a curve; then the width is refined between the
//! neighbours of the best one.

use super::loss::{Comparison, Loss};
use crate::base::math::brent::minimum;
use crate::base::math::order_statistics::median;
use crate::instrument::metrics::Epsilon;

/// Largest F0 of a fit. Above 1 it is not a material, but a fit without this freedom would hide
/// how much brightness the method lacks.
pub const F0_MAX: f64 = 3.0;
/// How exact the roughness of a fit is.
const ROUGHNESS_TOLERANCE: f64 = 2e-4;
/// How exact F0 is, relative to F0.
const F0_TOLERANCE: f64 = 2e-4;
/// The same, to tell which width of the grid is the best. A loss has its least value at the best F0,
/// so it is exact to the square of this.
const GRID_F0_TOLERANCE: f64 = 1e-2;
/// Every n-th value tells which width of the grid is the best. Not a multiple of three, so that all
/// channels count.
const GRID_STRIDE: usize = 4;
/// With fewer values than this all count there.
const GRID_VALUES_MIN: usize = 2048;
/// The F0 of a curved loss is sought within this factor of the relative loss's F0.
const F0_FACTOR: f64 = 4.0;

/// The image of a method at one width, as lines in F0: value = offset + slope F0.
#[derive(Clone, Debug, PartialEq)]
pub struct Lines {
    /// Perceptual roughness, √alpha.
    pub roughness: f64,
    pub offset: Vec<f64>,
    pub slope: Vec<f64>,
}

impl Lines {
    /// The lines through the values of images at two different F0.
    pub fn through(roughness: f64, [a, b]: [(f64, &[f64]); 2]) -> Self {
        let ((f0_a, values_a), (f0_b, values_b)) = (a, b);
        let slope: Vec<f64> = values_a
            .iter()
            .zip(values_b)
            .map(|(a, b)| (b - a) / (f0_b - f0_a))
            .collect();
        let offset = values_a.iter().zip(&slope);
        Self {
            roughness,
            offset: offset.map(|(a, slope)| a - slope * f0_a).collect(),
            slope,
        }
    }

    /// The image at an F0.
    pub fn at(&self, f0: f64) -> impl Iterator<Item = f64> {
        let lines = self.offset.iter().zip(&self.slope);
        lines.map(move |(offset, slope)| offset + slope * f0)
    }

    /// The lines of some values.
    pub fn selected(&self, indices: &[usize]) -> Self {
        let of = |all: &[f64]| indices.iter().map(|&index| all[index]).collect();
        Self {
            roughness: self.roughness,
            offset: of(&self.offset),
            slope: of(&self.slope),
        }
    }

    /// The lines at a roughness between two widths.
    fn between(&self, other: &Self, roughness: f64) -> Self {
        let part = (roughness - self.roughness) / (other.roughness - self.roughness);
        let mix = |a: &[f64], b: &[f64]| {
            let values = a.iter().zip(b);
            values.map(|(a, b)| (1.0 - part) * a + part * b).collect()
        };
        Self {
            roughness,
            offset: mix(&self.offset, &other.offset),
            slope: mix(&self.slope, &other.slope),
        }
    }
}

/// Photos of one surface, pooled.
#[derive(Clone, Debug, PartialEq)]
pub struct Photo {
    /// Linear values, three a pixel.
    pub values: Vec<f64>,
    pub epsilon: Epsilon,
    /// Factor before the curve of a loss.
    pub exposure: f64,
}

impl Photo {
    /// Exposes the photos so that their median value is 0.5.
    pub fn exposed(values: Vec<f64>, epsilon: Epsilon) -> Self {
        let middle = median(&values);
        let exposure = if middle > 0.0 { 0.5 / middle } else { 1.0 };
        Self {
            values,
            epsilon,
            exposure,
        }
    }

    /// The same exposure with some of the values.
    pub fn selected(&self, indices: &[usize]) -> Self {
        Self {
            values: indices.iter().map(|&index| self.values[index]).collect(),
            ..*self
        }
    }
}

/// A recovered material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// Perceptual roughness, within the widths of the images.
    pub roughness: f64,
    /// From 0 to [`F0_MAX`].
    pub f0: f64,
    /// Mean over the values.
    pub loss: f64,
}

/// Photos to explain by the images of a method under a loss.
#[derive(Clone, Copy, Debug)]
pub struct Problem<'a> {
    /// By roughness, ascending; at least one.
    pub lines: &'a [Lines],
    pub photo: &'a Photo,
    pub loss: Loss,
}

impl Problem<'_> {
    /// Recovers the material with the least loss.
    pub fn solve(&self) -> Fit {
        let photo = self.curved_photo();
        let best = self.best_width();
        let at_best = self.at_width(&self.lines[best], &photo, F0_TOLERANCE);
        let last = self.lines.len() - 1;
        let neighbours = [best.saturating_sub(1), (best + 1).min(last)];
        let refined = self.refined(neighbours.map(|index| self.lines[index].roughness), &photo);
        if refined.loss < at_best.loss {
            refined
        } else {
            at_best
        }
    }

    /// The loss of a material whose roughness is within the widths.
    pub fn loss_of(&self, roughness: f64, f0: f64) -> f64 {
        self.loss_at(&self.lines_at(roughness), &self.curved_photo(), f0)
    }

    /// The lines at a roughness within the widths.
    fn lines_at(&self, roughness: f64) -> Lines {
        let above = self
            .lines
            .partition_point(|lines| lines.roughness < roughness);
        let above = above.clamp(1, self.lines.len() - 1);
        self.lines[above - 1].between(&self.lines[above], roughness)
    }

    /// Index of the width with the least loss, by some of the values.
    fn best_width(&self) -> usize {
        let count = self.photo.values.len();
        let stride = if count < GRID_VALUES_MIN {
            1
        } else {
            GRID_STRIDE
        };
        let indices: Vec<usize> = (0..count).step_by(stride).collect();
        let lines: Vec<Lines> = self
            .lines
            .iter()
            .map(|lines| lines.selected(&indices))
            .collect();
        let some = Problem {
            lines: &lines,
            photo: &self.photo.selected(&indices),
            loss: self.loss,
        };
        let photo = some.curved_photo();
        let losses: Vec<f64> = lines
            .iter()
            .map(|lines| some.at_width(lines, &photo, GRID_F0_TOLERANCE).loss)
            .collect();
        (0..losses.len())
            .min_by(|&a, &b| losses[a].total_cmp(&losses[b]))
            .expect("at least one width")
    }

    /// Whether a fit ends at a limit of the roughness or of F0.
    pub fn is_at_limit(&self, fit: &Fit) -> bool {
        let ends = [self.lines.first(), self.lines.last()];
        let is_end = |lines: &Lines| (lines.roughness - fit.roughness).abs() < ROUGHNESS_TOLERANCE;
        ends.into_iter().flatten().any(is_end)
            || fit.f0 <= 0.0
            || fit.f0 >= F0_MAX * (1.0 - F0_TOLERANCE)
    }

    /// The best material between two widths of roughness; `curved_photo` as made by
    /// [`Self::curved_photo`].
    fn refined(&self, widths: [f64; 2], curved_photo: &[f64]) -> Fit {
        let at = |roughness| self.at_width(&self.lines_at(roughness), curved_photo, F0_TOLERANCE);
        at(minimum(
            |roughness| at(roughness).loss,
            widths,
            ROUGHNESS_TOLERANCE,
        ))
    }

    /// The best F0 at a width, to a relative tolerance.
    fn at_width(&self, lines: &Lines, curved_photo: &[f64], tolerance: f64) -> Fit {
        let f0 = match self.loss.comparison() {
            Comparison::Weighted(weight) => self.least_squares(lines, weight),
            Comparison::Curved { .. } => {
                let near = self.least_squares(lines, |p, epsilon| epsilon.relative(1.0, p));
                let ends = [near / F0_FACTOR, (near * F0_FACTOR).min(F0_MAX)];
                let loss = |f0| self.loss_at(lines, curved_photo, f0);
                minimum(loss, ends, tolerance * near.max(F0_TOLERANCE))
            }
        };
        Fit {
            roughness: lines.roughness,
            f0,
            loss: self.loss_at(lines, curved_photo, f0),
        }
    }

    /// The F0 in [0, [`F0_MAX`]] of the least Σ w (offset + slope F0 - p)².
    fn least_squares(&self, lines: &Lines, weight: fn(f64, Epsilon) -> f64) -> f64 {
        let photo = self.photo;
        let values = lines.offset.iter().zip(&lines.slope).zip(&photo.values);
        let [mut product, mut square] = [0.0; 2];
        for ((offset, slope), p) in values {
            let w = weight(*p, photo.epsilon);
            product += w * slope * (p - offset);
            square += w * slope * slope;
        }
        if square > 0.0 {
            (product / square).clamp(0.0, F0_MAX)
        } else {
            0.0
        }
    }

    /// The values of the photo after the curve of the loss; as they are without a curve.
    fn curved_photo(&self) -> Vec<f64> {
        let photo = self.photo;
        match self.loss.comparison() {
            Comparison::Weighted(_) => photo.values.clone(),
            Comparison::Curved { curve, .. } => {
                let values = photo.values.iter();
                values.map(|p| curve(photo.exposure * p.max(0.0))).collect()
            }
        }
    }

    /// The mean loss at an F0; `curved_photo` as made by [`Self::curved_photo`].
    fn loss_at(&self, lines: &Lines, curved_photo: &[f64], f0: f64) -> f64 {
        let Photo {
            values,
            epsilon,
            exposure,
        } = self.photo;
        let sum: f64 = match self.loss.comparison() {
            Comparison::Weighted(weight) => {
                let pairs = lines.at(f0).zip(values);
                pairs
                    .map(|(m, p)| weight(*p, *epsilon) * (m - p).powi(2))
                    .sum()
            }
            Comparison::Curved { curve, distance } => {
                let pairs = lines.at(f0).zip(curved_photo);
                pairs
                    .map(|(m, p)| distance(curve(exposure * m.max(0.0)) - p))
                    .sum()
            }
        };
        sum / values.len() as f64
    }
}
