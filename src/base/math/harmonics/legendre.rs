//! The associated Legendre functions of many rows at once: orthonormal, by recurrence in the
//! degree.

use glam::DVec3;
use std::f64::consts::PI;

/// Row pairs per recurrence. Each step of a recurrence waits for the one before, so a processor has
/// time for this many side by side.
pub(super) const LANES: usize = 8;
/// Constants of the recurrence of `P_lm`, the same for all rows.
#[derive(Clone, Debug)]
pub(super) struct Legendre {
    /// By order m: logarithm of `P_mm / sin^m θ`, which may be as small as 1e-300.
    first: Vec<f64>,
    /// By order m and l from m on: a and b of `P_l+1 = a cos θ P_l - b P_l-1`.
    steps: Vec<Vec<[f64; 2]>>,
}

/// Rows at θ and their mirrors at π - θ: sum and difference serve even and odd l + m.
pub(super) struct Block {
    cos: [f64; LANES],
    sin: [f64; LANES],
}

/// Margin of the test `m > degree sin θ + margin`, beyond which functions of order m are below
/// 1e-12.
pub fn margin(degree: usize) -> f64 {
    7.0 * (degree as f64).cbrt().max(4.0)
}

impl Block {
    /// Makes blocks of the northern rows of `count` rows at `π (i + 1/2)/count`, to the equator;
    /// padded with the last.
    pub(super) fn all(count: usize) -> Vec<Self> {
        let pairs = count.div_ceil(2);
        let block = |first: usize| {
            let theta: [f64; LANES] = std::array::from_fn(|lane| {
                PI * ((first + lane).min(pairs - 1) as f64 + 0.5) / count as f64
            });
            Self {
                cos: theta.map(f64::cos),
                sin: theta.map(f64::sin),
            }
        };
        (0..pairs).step_by(LANES).map(block).collect()
    }

    /// Makes a block of at most [`LANES`] unit directions; padded with the last.
    pub(super) fn from_directions(directions: &[DVec3]) -> Self {
        let lanes: [DVec3; LANES] =
            std::array::from_fn(|lane| directions[lane.min(directions.len() - 1)]);
        Self {
            cos: lanes.map(|d| d.y),
            sin: lanes.map(|d| d.x.hypot(d.z).max(1e-12)),
        }
    }
}

/// ln of `P_mm / sin^m θ` = sqrt((2m + 1)/4π Π (2k - 1)/2k) with k = 1 to m.
fn log_of_first(m: usize) -> f64 {
    let halves: f64 = (1..=m)
        .map(|k| 0.5 * ((2 * k - 1) as f64 / (2 * k) as f64).ln())
        .sum();
    0.5 * ((2 * m + 1) as f64 / (4.0 * PI)).ln() + halves
}

/// The factors `[a_l+1, a_l+1 / a_l]` of P_l+1 = a_l+1 (cos θ P_l - P_l-1 / a_l), a_l² = (4 l² -
/// 1)/(l² - m²), for l = m to `degree` - 1.
fn steps_of_order(m: usize, degree: usize) -> Vec<[f64; 2]> {
    let factor = |l: f64| ((4.0 * l * l - 1.0) / (l * l - (m * m) as f64)).sqrt();
    let mut last = f64::INFINITY;
    (m..degree)
        .map(|l| {
            let current = factor((l + 1) as f64);
            let step = [current, current / last];
            last = current;
            step
        })
        .collect()
}

impl Legendre {
    pub(super) fn new(degree: usize) -> Self {
        Self {
            first: (0..=degree).map(log_of_first).collect(),
            steps: (0..=degree).map(|m| steps_of_order(m, degree)).collect(),
        }
    }

    /// Computes `P_lm` for l = m to `degree` at the rows of a block; false if all are practically
    /// 0.
    pub(super) fn fill(
        &self,
        m: usize,
        degree: usize,
        block: &Block,
        found: &mut Vec<[f64; LANES]>,
    ) -> bool {
        let reach = degree as f64;
        if block
            .sin
            .iter()
            .all(|sin| m as f64 > reach * sin + margin(degree))
        {
            return false;
        }
        let mut last = [0.0; LANES];
        let mut current = block
            .sin
            .map(|sin| (self.first[m] + m as f64 * sin.ln()).exp());
        let cos = block.cos;
        let steps = &self.steps[m][..degree - m];
        found.resize(degree - m + 1, current);
        found[0] = current;
        for (value, [a, b]) in found[1..].iter_mut().zip(steps) {
            (0..LANES)
                .for_each(|lane| value[lane] = a * cos[lane] * current[lane] - b * last[lane]);
            (last, current) = (current, *value);
        }
        true
    }
}
