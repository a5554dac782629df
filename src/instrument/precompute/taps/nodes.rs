//! The taps at the nodes of a table: each fitted from its neighbours' and pulled towards their
//! mean.

use super::chain::Chain;
use super::fit::{Fit, Parameters};
use super::lobe::Lobe;
use super::{F0, Tap, TapCount};
use crate::instrument::brdf::{
    Brdf, FresnelWeight, MaskingShadowing, alpha_from_perceptual_roughness,
};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

pub const SIDE: usize = 17;

/// Rows of a smaller level are not fitted.
const LEVEL_FIRST: f64 = 0.35;

/// Penalty of squared differences to the mean of the neighbours' parameters.
const SMOOTH: f64 = 0.5;
/// The same where a node first starts from one neighbour.
const FIRST_SMOOTH: f64 = 3e-5;
/// How often every node is fitted again, pulled towards its neighbours.
const SWEEP_COUNT: u32 = 8;

/// Returns `(n_dot_v, alpha)` of a node. Facing the viewer the plane of incidence is undefined.
pub fn parameters_from_node([x, y]: [usize; 2]) -> DVec2 {
    let at = DVec2::new(x as f64, y as f64) / (SIDE - 1) as f64;
    DVec2::new(
        (at.x * at.x).clamp(2e-3, 0.985),
        alpha_from_perceptual_roughness(at.y),
    )
}

/// Where every search starts.
pub fn first_guess(count: TapCount) -> &'static [f64] {
    match count {
        TapCount::One => &[0.0, 0.0],
        TapCount::Two => &[0.1, -0.3, -0.5, 0.2, 0.4],
        TapCount::Four => &[0.0, -0.3, -0.6, 0.2, 0.3, 0.3, -0.4, 0.3, -0.2, -0.4, 0.1],
    }
}

/// The taps of every node from the first fitted row on.
pub struct Nodes<'a> {
    chain: &'a Chain,
    first_row: usize,
    /// Over f0, row, column.
    fits: Vec<Fit<'a>>,
    parameters: Vec<Parameters>,
}

/// Indices of a node: f0, row, column.
type NodeIndex = [usize; 3];

impl<'a> Nodes<'a> {
    pub fn new(
        chain: &'a Chain,
        brdf: &'static dyn Brdf,
        masking: MaskingShadowing,
        fresnel: FresnelWeight,
        count: TapCount,
    ) -> Self {
        let is_filtered = |y: &usize| chain.level(parameters_from_node([0, *y]).y) > LEVEL_FIRST;
        let first_row = (0..SIDE)
            .find(is_filtered)
            .expect("the last row is the last level");
        let fit = |[f0, y, x]: NodeIndex| {
            let DVec2 {
                x: n_dot_v,
                y: alpha,
            } = parameters_from_node([x, y]);
            let lobe = Lobe::reflecting(brdf, masking, fresnel, n_dot_v, alpha);
            let share = lobe.albedos.y / (F0[f0] * lobe.albedos.x + lobe.albedos.y);
            let densities = |all: &[DVec3]| all.iter().map(|l| lobe.density(share, *l)).collect();
            Fit::new(
                chain,
                [n_dot_v, alpha],
                lobe.moment_angle(share),
                count,
                densities,
            )
        };
        let nodes: Vec<NodeIndex> = (0..F0.len() * (SIDE - first_row) * SIDE)
            .map(|i| node_index(first_row, i))
            .collect();
        let fits: Vec<Fit> = nodes.par_iter().map(|node| fit(*node)).collect();
        let mut nodes = Self {
            chain,
            first_row,
            parameters: vec![first_guess(count).to_vec(); fits.len()],
            fits,
        };
        nodes.start();
        (0..SWEEP_COUNT).for_each(|_| nodes.sweep());
        nodes
    }

    fn index(&self, [f0, y, x]: NodeIndex) -> usize {
        (f0 * (SIDE - self.first_row) + y - self.first_row) * SIDE + x
    }

    /// Fits nodes, each from another's parameters.
    fn solve_from(&mut self, pairs: &[(NodeIndex, NodeIndex)]) {
        let solve = |(to, from): &(NodeIndex, NodeIndex)| {
            let fit = &self.fits[self.index(*to)];
            let start = &self.parameters[self.index(*from)];
            fit.solve(start, start, FIRST_SMOOTH)
        };
        let found: Vec<Parameters> = pairs.par_iter().map(solve).collect();
        for ((to, _), parameters) in pairs.iter().zip(found) {
            let index = self.index(*to);
            self.parameters[index] = parameters;
        }
    }

    /// Fits for each f0 the middle column from its middle, and all columns from it; the second f0
    /// begins with the first's middle.
    fn start(&mut self) {
        let column = SIDE / 2;
        let row = (self.first_row + SIDE) / 2;
        for f0 in 0..F0.len() {
            self.solve_from(&[([f0, row, column], [0, row, column])]);
            for [to, from] in outwards(row, self.first_row) {
                self.solve_from(&[([f0, to, column], [f0, from, column])]);
            }
            for [to, from] in outwards(column, 0) {
                let pairs: Vec<_> = (self.first_row..SIDE)
                    .map(|y| ([f0, y, to], [f0, y, from]))
                    .collect();
                self.solve_from(&pairs);
            }
        }
    }

    /// Fits every other node again, pulled towards the mean of its neighbours, then the rest.
    fn sweep(&mut self) {
        for parity in 0..2 {
            let nodes = (0..self.fits.len()).map(|i| node_index(self.first_row, i));
            let chosen: Vec<NodeIndex> = nodes
                .filter(|node| node.iter().sum::<usize>() % 2 == parity)
                .collect();
            let solve = |node: &NodeIndex| {
                let index = self.index(*node);
                self.fits[index].solve(&self.parameters[index], &self.mean_around(*node), SMOOTH)
            };
            let found: Vec<Parameters> = chosen.par_iter().map(solve).collect();
            for (node, parameters) in chosen.into_iter().zip(found) {
                let index = self.index(node);
                self.parameters[index] = parameters;
            }
        }
    }

    fn mean_around(&self, [f0, y, x]: NodeIndex) -> Parameters {
        let mut around = vec![[1 - f0, y, x]];
        around.extend((x > 0).then(|| [f0, y, x - 1]));
        around.extend((x + 1 < SIDE).then_some([f0, y, x + 1]));
        around.extend((y > self.first_row).then(|| [f0, y - 1, x]));
        around.extend((y + 1 < SIDE).then_some([f0, y + 1, x]));
        let parameters: Vec<&Parameters> = around
            .iter()
            .map(|node| &self.parameters[self.index(*node)])
            .collect();
        let mean =
            |p: usize| parameters.iter().map(|of| of[p]).sum::<f64>() / parameters.len() as f64;
        (0..parameters[0].len()).map(mean).collect()
    }

    /// Returns the taps of a node by f0. In rows above the first fitted one they are drawn towards
    /// r at level 0, in proportion to alpha.
    pub fn taps(&self, f0: usize, [x, y]: [usize; 2]) -> Vec<Tap> {
        let fitted = y.max(self.first_row);
        let index = self.index([f0, fitted, x]);
        let [own, of_fitted] = [y, fitted].map(|y| parameters_from_node([x, y]));
        let theta = own.x.acos();
        let closer = own.y / of_fitted.y;
        let levels = self.chain.level(own.y) / self.chain.level(of_fitted.y);
        let draw = |tap: Tap| Tap {
            angle: theta + (tap.angle - theta) * closer,
            level: tap.level * levels,
            weight: tap.weight,
        };
        self.fits[index]
            .taps(&self.parameters[index])
            .into_iter()
            .map(draw)
            .collect()
    }
}

/// Returns f0, row and column of a node by its index.
fn node_index(first_row: usize, index: usize) -> NodeIndex {
    let rows = SIDE - first_row;
    [
        index / SIDE / rows,
        first_row + index / SIDE % rows,
        index % SIDE,
    ]
}

/// Lists the nodes from `low` to the last, from `middle` outwards, each with the one before.
fn outwards(middle: usize, low: usize) -> impl Iterator<Item = [usize; 2]> {
    (low..middle)
        .rev()
        .map(|to| [to, to + 1])
        .chain((middle + 1..SIDE).map(|to| [to, to - 1]))
}
