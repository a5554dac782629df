//! The quadtree of exact weights: `W_ij` of cells, and of parents from their children.

use super::{EquirectQuadrature, Node, Region, Weights, middle_knot};
use crate::base::math::quadrature::NODE_COUNT;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// Most bilinear cells per side of a leaf of the quadtree: 12 halves to 6, and 8 (a power of two)
/// plus the row that the poles' half cells add still fits.
const LEAF_CELLS: usize = 12;

impl EquirectQuadrature {
    /// Counts the nodes of a region and everything below it.
    pub(super) fn node_count(&self, region: &Region) -> usize {
        let below = if is_leaf(region) {
            Vec::new()
        } else {
            branches(region)
        };
        1 + below
            .iter()
            .map(|child| self.node_count(child))
            .sum::<usize>()
    }

    /// Builds the node of a region and everything below it.
    pub(super) fn build(&mut self, region: Region) -> Region {
        let node = if is_leaf(&region) {
            let (weights, mass) = self.weights(&region);
            Node {
                weights,
                mass,
                children: Vec::new(),
            }
        } else {
            let children: Vec<Region> = branches(&region)
                .into_iter()
                .map(|child| self.build(child))
                .collect();
            self.merge(&region, children)
        };
        self.nodes.push(node);
        Region {
            node: Some(self.nodes.len() - 1),
            ..region
        }
    }

    /// Makes the node over `children`: `W_ij = Σ_children Σ_kl ℓ_i(x_k) ℓ_j(y_l) W_kl`, in the
    /// parent's coordinates.
    fn merge(&self, region: &Region, children: Vec<Region>) -> Node {
        let mut weights = [[DVec3::ZERO; NODE_COUNT]; NODE_COUNT];
        let mut mass = DVec3::ZERO;
        for child in &children {
            let Some(node) = child.node.map(|index| &self.nodes[index]) else {
                continue;
            };
            let lagrange = |low: f64, high: f64, parent_low: f64, parent_high: f64| {
                self.rule.gauss.nodes.map(|x| {
                    let position = 0.5 * (low + high) + 0.5 * (high - low) * x;
                    self.rule.gauss.lagrange(
                        (2.0 * position - parent_low - parent_high) / (parent_high - parent_low),
                    )
                })
            };
            let along_x = lagrange(child.low.x, child.high.x, region.low.x, region.high.x);
            let along_y = lagrange(child.low.y, child.high.y, region.low.y, region.high.y);
            for (column, x) in node.weights.iter().zip(&along_x) {
                let partial: [DVec3; NODE_COUNT] = std::array::from_fn(|j| {
                    column
                        .iter()
                        .zip(&along_y)
                        .map(|(&weight, y)| weight * y[j])
                        .sum()
                });
                for i in 0..NODE_COUNT {
                    for j in 0..NODE_COUNT {
                        weights[i][j] += partial[j] * x[i];
                    }
                }
            }
            mass += node.mass;
        }
        Node {
            weights,
            mass,
            children,
        }
    }

    /// Computes `W_ij` and `∫ |L| dω` of a region exactly: hat functions and sin(π v) are
    /// integrated by cell.
    pub(super) fn weights(&self, region: &Region) -> (Weights, DVec3) {
        let columns = self.hat_integrals(region.low.x, region.high.x, |_| {
            2.0 * PI / self.width as f64
        });
        let rows = self.hat_integrals(region.low.y, region.high.y, |y| {
            let step = PI / self.height as f64;
            step * (step * (y + 0.5)).sin()
        });
        let mut weights = [[DVec3::ZERO; NODE_COUNT]; NODE_COUNT];
        let mut mass = DVec3::ZERO;
        for row in &rows {
            // Rows clamp: beyond the last centres the map is constant in v.
            let y = row.texel.clamp(0, self.height as i64 - 1) as usize;
            let mut sums = [DVec3::ZERO; NODE_COUNT];
            for column in &columns {
                let x = column.texel.rem_euclid(self.width as i64) as usize;
                let radiance = DVec3::from_array(self.texels[y * self.width + x].map(f64::from));
                for (sum, integral) in sums.iter_mut().zip(&column.integrals) {
                    *sum += radiance * *integral;
                }
                mass += radiance.abs() * (column.total * row.total);
            }
            for (weights, sum) in weights.iter_mut().zip(sums) {
                for (weight, integral) in weights.iter_mut().zip(&row.integrals) {
                    *weight += sum * *integral;
                }
            }
        }
        (weights, mass)
    }

    /// Integrates `∫ hat_t(x) ℓ_i(x) measure(x) dx` over `[low, high]` for every texel t with a hat
    /// in it.
    fn hat_integrals(
        &self,
        low: f64,
        high: f64,
        measure: impl Fn(f64) -> f64,
    ) -> Vec<HatIntegrals> {
        let gauss = &self.rule.gauss;
        let first = low.floor() as i64;
        let mut hats: Vec<HatIntegrals> = (first..=high.ceil() as i64)
            .map(|texel| HatIntegrals {
                texel,
                integrals: [0.0; NODE_COUNT],
                total: 0.0,
            })
            .collect();
        let mut start = low;
        while start < high {
            let cell = start.floor();
            let end = (cell + 1.0).min(high);
            let whole = start == low && end == high;
            let half = 0.5 * (end - start);
            for q in 0..NODE_COUNT {
                let x = 0.5 * (start + end) + half * gauss.nodes[q];
                let weight = half * gauss.weights[q] * measure(x);
                // Within one cell the nodes of quadrature and interpolant coincide, so ℓ is 0 or 1.
                let lagrange = if whole {
                    std::array::from_fn(|i| f64::from(u8::from(i == q)))
                } else {
                    gauss.lagrange((2.0 * x - low - high) / (high - low))
                };
                let index = (cell as i64 - first) as usize;
                for (hat, share) in [(index, cell + 1.0 - x), (index + 1, x - cell)] {
                    hats[hat].total += weight * share;
                    for (integral, value) in hats[hat].integrals.iter_mut().zip(&lagrange) {
                        *integral += weight * share * value;
                    }
                }
            }
            start = end;
        }
        hats
    }
}

fn is_leaf(region: &Region) -> bool {
    (region.high - region.low).max_element() <= LEAF_CELLS as f64
}

/// Splits a node along each axis that is longer than a leaf. A map of one row has no thinner
/// leaves.
fn branches(region: &Region) -> Vec<Region> {
    let parts = |low: f64, high: f64| {
        if high - low > LEAF_CELLS as f64 {
            let middle = middle_knot(low, high);
            vec![(low, middle), (middle, high)]
        } else {
            vec![(low, high)]
        }
    };
    let columns = parts(region.low.x, region.high.x);
    let rows = parts(region.low.y, region.high.y).into_iter();
    rows.flat_map(|y| {
        columns.iter().map(move |x| Region {
            low: DVec2::new(x.0, y.0),
            high: DVec2::new(x.1, y.1),
            node: None,
        })
    })
    .collect()
}

/// Integrals of one texel's hat function along one axis.
struct HatIntegrals {
    texel: i64,
    integrals: [f64; NODE_COUNT],
    total: f64,
}
