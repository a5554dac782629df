//! Metrics by n·v.

use super::comparison::{check_size, column_and_row};
use super::{Comparison, Metric, MetricsError};
use crate::base::pixels::GrayImage;

/// Ten bins of width 0.1, from grazing (0) to facing the viewer (1).
pub const N_DOT_V_BIN_EDGES: [f64; 11] = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0];

/// All n·v.
pub const ALL_VIEWS: [f64; 2] = [0.0, 1.0];

/// Bands of n·v, from grazing to facing.
pub const VIEWS: [[f64; 2]; 5] = [[0.0, 0.2], [0.2, 0.4], [0.4, 0.6], [0.6, 0.8], [0.8, 1.0]];

/// Scores of pixels with n·v in [`lo`, `hi`).
#[derive(Clone, Debug, PartialEq)]
pub struct BinRow {
    pub lo: f64,
    pub hi: f64,
    pub pixel_count: usize,
    /// RGB mean of the reference; 0 without pixels.
    pub reference_mean: f64,
    /// By metric; empty without pixels.
    pub values: Vec<(&'static str, f64)>,
}

impl Comparison<'_> {
    /// Evaluates metrics per bin of n·v. Values outside the edges count in the first or last bin.
    /// Display metrics pool the maps of the whole image.
    pub fn evaluate_bins(
        &self,
        n_dot_v: &GrayImage,
        edges: &[f64],
        metrics: &[&Metric],
    ) -> Result<Vec<BinRow>, MetricsError> {
        let bins = self
            .bin_pixels(n_dot_v, edges)?
            .into_iter()
            .zip(edges.windows(2));
        let row = |(pixels, edge): (Vec<usize>, &[f64])| BinRow {
            lo: edge[0],
            hi: edge[1],
            pixel_count: pixels.len(),
            reference_mean: self.reference_mean(&pixels),
            values: if pixels.is_empty() {
                Vec::new()
            } else {
                self.evaluate_pixels(metrics, &pixels)
            },
        };
        Ok(bins.map(row).collect())
    }

    /// Returns the row-major indices of the masked pixels of each bin.
    pub fn bin_pixels(
        &self,
        n_dot_v: &GrayImage,
        edges: &[f64],
    ) -> Result<Vec<Vec<usize>>, MetricsError> {
        check_size("n_dot_v image", n_dot_v, self.size())?;
        let increasing = edges.windows(2).all(|pair| pair[0] < pair[1]);
        if edges.len() < 2 || !increasing || !edges.iter().all(|edge| edge.is_finite()) {
            return Err(MetricsError::BinEdges {
                edges: edges.to_vec(),
            });
        }
        let bin_count = edges.len() - 1;
        let mut bins = vec![Vec::new(); bin_count];
        for &pixel in self.pixels() {
            let value = n_dot_v.data[pixel];
            if !value.is_finite() {
                let [x, y] = column_and_row(pixel, n_dot_v.width);
                return Err(MetricsError::Cosine { x, y, value });
            }
            let edges_passed = edges.partition_point(|&edge| edge <= f64::from(value));
            bins[edges_passed.clamp(1, bin_count) - 1].push(pixel);
        }
        Ok(bins)
    }
}
