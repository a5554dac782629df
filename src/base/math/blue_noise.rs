//! A spatio-temporal mask of blue noise by void and cluster \[Ulichney93\] \[Wolfe22\].
//!
//! The ranks of the cells of a torus of [`SIDE`] x [`SIDE`] pixels and [`DEPTH`] frames. Cells
//! repel each other by `exp(-d²/(2 σ²))` within a frame, d in pixels, and within a pixel, d in
//! frames; others do not. So each frame and each pixel over time has few low frequencies. Cells get
//! their ranks in turn, each in the largest void of the cells before it; the first tenth is spread
//! out from random cells.

use std::sync::LazyLock;

pub const SIDE: usize = 64;
pub const DEPTH: usize = 32;
const AREA: usize = SIDE * SIDE;
/// Width of the repulsion, pixels or frames.
const SIGMA: f64 = 1.9;
/// Share of the cells that the algorithm spreads out first.
const FIRST: usize = AREA * DEPTH / 10;

/// The mask: `(rank + 1/2) / count`, x fastest and frames slowest. Made at first use, in seconds.
static MASK: LazyLock<Vec<f64>> = LazyLock::new(|| {
    let mut cells = Cells::new();
    // A random order, by xorshift.
    let mut state = 1u32;
    let mut random = |_: &usize| {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        state
    };
    let mut order: Vec<usize> = (0..AREA * DEPTH).collect();
    order.sort_by_cached_key(&mut random);
    order[..FIRST].iter().for_each(|&cell| cells.flip(cell));
    loop {
        let cluster = cells.extreme(true);
        cells.flip(cluster);
        let void = cells.extreme(false);
        cells.flip(void);
        if void == cluster {
            break;
        }
    }
    let mut ranks = vec![0.0; AREA * DEPTH];
    let rank = |index: usize| (index as f64 + 0.5) / (AREA * DEPTH) as f64;
    let spread = cells.clone();
    for index in (0..FIRST).rev() {
        let cluster = cells.extreme(true);
        cells.flip(cluster);
        ranks[cluster] = rank(index);
    }
    let mut cells = spread;
    for index in FIRST..AREA * DEPTH {
        let void = cells.extreme(false);
        cells.flip(void);
        ranks[void] = rank(index);
    }
    ranks
});

/// A set of cells and its energy.
#[derive(Clone)]
struct Cells {
    is_in: Vec<bool>,
    energy: Vec<f64>,
    /// The largest void and the tightest cluster of each frame; `None` if unknown.
    best: [Vec<Option<usize>>; 2],
    /// The repulsion along one axis, by distance.
    repulsion: [f64; SIDE],
}

impl Cells {
    fn new() -> Self {
        let repulsion = std::array::from_fn(|d| (-0.5 * (d as f64 / SIGMA).powi(2)).exp());
        let best = [vec![None; DEPTH], vec![None; DEPTH]];
        Self {
            is_in: vec![false; AREA * DEPTH],
            energy: vec![0.0; AREA * DEPTH],
            best,
            repulsion,
        }
    }

    fn flip(&mut self, cell: usize) {
        self.is_in[cell] = !self.is_in[cell];
        let sign = if self.is_in[cell] { 1.0 } else { -1.0 };
        let frame = cell / AREA;
        let pixel = cell % AREA;
        let around = |a: usize, b: usize, length: usize| a.abs_diff(b).min(length - a.abs_diff(b));
        let along_x: [f64; SIDE] =
            std::array::from_fn(|x| sign * self.repulsion[around(x, pixel % SIDE, SIDE)]);
        for (y, row) in self.energy[frame * AREA..(frame + 1) * AREA]
            .chunks_exact_mut(SIDE)
            .enumerate()
        {
            let along_y = self.repulsion[around(y, pixel / SIDE, SIDE)];
            row.iter_mut()
                .zip(along_x)
                .for_each(|(energy, x)| *energy += x * along_y);
        }
        for other in (0..DEPTH).filter(|&other| other != frame) {
            self.energy[other * AREA + pixel] += sign * self.repulsion[around(other, frame, DEPTH)];
        }
        // In another frame one energy moved: its extremes may only have become this cell, or no
        // longer be it.
        for (is_cluster, best) in [false, true].into_iter().zip(&mut self.best) {
            for (other, best) in best.iter_mut().enumerate() {
                let moved = other * AREA + pixel;
                let is_beaten = |known: usize| {
                    self.is_in[moved] == is_cluster
                        && (self.energy[moved] > self.energy[known]) == is_cluster
                };
                *best = best.filter(|&known| other != frame && known != moved && !is_beaten(known));
            }
        }
    }

    /// Finds the tightest cluster of the set, or its largest void.
    fn extreme(&mut self, is_cluster: bool) -> usize {
        let is_in = &self.is_in;
        let energy = &self.energy;
        let order = |a: &usize, b: &usize| {
            let by_energy = energy[*a].total_cmp(&energy[*b]);
            if is_cluster {
                by_energy
            } else {
                by_energy.reverse()
            }
        };
        let best = self.best[usize::from(is_cluster)]
            .iter_mut()
            .enumerate()
            .filter_map(|(frame, best)| {
                if best.is_none() {
                    let cells_of_frame = frame * AREA..(frame + 1) * AREA;
                    *best = cells_of_frame
                        .filter(|&cell| is_in[cell] == is_cluster)
                        .max_by(order);
                }
                *best
            });
        best.max_by(order)
            .expect("the set is neither empty nor whole")
    }
}

/// Returns the mask at a column, row and frame; it repeats in all three.
pub fn value([x, y]: [u32; 2], frame: u32) -> f64 {
    let [x, y, frame] = [(x, SIDE), (y, SIDE), (frame, DEPTH)]
        .map(|(coordinate, length)| coordinate as usize % length);
    MASK[frame * AREA + y * SIDE + x]
}
