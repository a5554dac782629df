//! Integration in f64: Gauss-Legendre nodes and adaptive cubature with an error estimate.

use glam::{DVec2, DVec3};
use std::collections::BinaryHeap;
use std::f64::consts::PI;

/// The `N`-point Gauss-Legendre rule: ascending nodes in (-1, 1) and weights; exact for polynomials
/// of degree `2N - 1`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaussLegendre<const N: usize> {
    pub nodes: [f64; N],
    pub weights: [f64; N],
}

impl<const N: usize> GaussLegendre<N> {
    /// Computes the rule by Newton's method on the Legendre polynomial.
    pub fn new() -> Self {
        const NEWTON_STEPS: u32 = 8;
        let mut rule = Self {
            nodes: [0.0; N],
            weights: [0.0; N],
        };
        for k in 0..N {
            // The classical first guess (descending) is close enough for quadratic convergence.
            let mut x = (PI * (k as f64 + 0.75) / (N as f64 + 0.5)).cos();
            let mut slope = 0.0;
            for _ in 0..NEWTON_STEPS {
                let (p, p_previous) = legendre_pair(N, x);
                slope = N as f64 * (x * p - p_previous) / (x * x - 1.0);
                x -= p / slope;
            }
            rule.nodes[N - 1 - k] = x;
            rule.weights[N - 1 - k] = 2.0 / ((1.0 - x * x) * slope * slope);
        }
        rule
    }

    pub fn integrate(&self, low: f64, high: f64, f: impl Fn(f64) -> f64) -> f64 {
        let center = 0.5 * (low + high);
        let half = 0.5 * (high - low);
        half * (0..N)
            .map(|k| self.weights[k] * f(center + half * self.nodes[k]))
            .sum::<f64>()
    }

    /// Returns the values at `x` of the `N` polynomials that are 1 at one node and 0 at the others.
    pub fn lagrange(&self, x: f64) -> [f64; N] {
        std::array::from_fn(|k| {
            (0..N)
                .filter(|&j| j != k)
                .map(|j| (x - self.nodes[j]) / (self.nodes[k] - self.nodes[j]))
                .product()
        })
    }
}

impl<const N: usize> Default for GaussLegendre<N> {
    fn default() -> Self {
        Self::new()
    }
}

/// Returns `P_degree(x)` and `P_(degree - 1)(x)`.
fn legendre_pair(degree: usize, x: f64) -> (f64, f64) {
    let mut p = x;
    let mut previous = 1.0;
    for k in 2..=degree {
        let k = k as f64;
        (p, previous) = (((2.0 * k - 1.0) * x * p - (k - 1.0) * previous) / k, p);
    }
    (p, previous)
}

/// `K` integrals of three channels each, with error estimates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate<const K: usize> {
    pub value: [DVec3; K],
    /// Upper estimate of the absolute error, by channel.
    pub error: [DVec3; K],
}

/// Three numbers (mostly linear RGB) with error bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounded {
    pub value: DVec3,
    /// Upper estimate of the absolute error, by channel.
    pub error: DVec3,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Error of each number relative to it, or to [`SCALE_FLOOR`] times the largest number if that
    /// is more.
    pub relative: f64,
    /// Most parts, for integrands that never converge. The estimate has the reached error.
    pub max_part_count: usize,
}

/// See [`Tolerance::relative`].
pub const SCALE_FLOOR: f64 = 0.01;

impl<const K: usize> Estimate<K> {
    const ZERO: Self = Self {
        value: [DVec3::ZERO; K],
        error: [DVec3::ZERO; K],
    };

    fn add(&mut self, other: &Self, factor: f64) {
        for k in 0..K {
            self.value[k] += factor * other.value[k];
            self.error[k] += factor * other.error[k];
        }
    }

    /// Returns `Σ factors[k] value[k]` with its bound.
    pub fn combine(&self, factors: [DVec3; K]) -> Bounded {
        let sum = |numbers: &[DVec3; K], factor: &dyn Fn(usize) -> DVec3| {
            (0..K).map(|k| numbers[k] * factor(k)).sum()
        };
        Bounded {
            value: sum(&self.value, &|k| factors[k]),
            error: sum(&self.error, &|k| factors[k].abs()),
        }
    }

    /// Returns the number that each error is relative to.
    fn scale(&self) -> [DVec3; K] {
        let largest = self
            .value
            .iter()
            .map(|value| value.abs().max_element())
            .fold(0.0, f64::max);
        self.value
            .map(|value| value.abs().max(DVec3::splat(SCALE_FLOOR * largest)))
    }

    /// Returns the largest error relative to `scale`; 0/0 counts as 0, NaN as infinite.
    fn relative_error(&self, scale: &[DVec3; K]) -> f64 {
        let channel = |error: f64, scale: f64| match error / scale {
            relative if !relative.is_nan() => relative.max(0.0),
            _ if error == 0.0 => 0.0,
            _ => f64::INFINITY,
        };
        let largest = |k: usize| {
            (0..3)
                .map(|c| channel(self.error[k][c], scale[k][c]))
                .fold(0.0, f64::max)
        };
        (0..K).map(largest).fold(0.0, f64::max)
    }
}

/// Integrates adaptively: splits the region with the largest error until the sum of errors meets
/// `tolerance`.
///
/// The sum of the regions' errors is an upper estimate of the total error if each region's is.
pub fn integrate_adaptively<R, I: IntoIterator<Item = R>, const K: usize>(
    roots: impl IntoIterator<Item = R>,
    estimate: impl Fn(&R) -> Estimate<K>,
    split: impl Fn(&R) -> I,
    tolerance: Tolerance,
) -> Estimate<K> {
    let estimated = |region: R| {
        let estimate = estimate(&region);
        (region, estimate)
    };
    let mut parts: Vec<(R, Estimate<K>)> = roots.into_iter().map(estimated).collect();
    let mut total = Estimate::ZERO;
    parts
        .iter()
        .for_each(|(_, estimate)| total.add(estimate, 1.0));
    let mut scale = total.scale();
    // Errors are not negative, so their bits have the same order.
    let priority =
        |estimate: &Estimate<K>, scale: &[DVec3; K]| estimate.relative_error(scale).to_bits();
    let first = parts
        .iter()
        .enumerate()
        .map(|(index, (_, estimate))| (priority(estimate, &scale), index));
    let mut worst_first: BinaryHeap<(u64, usize)> = first.collect();
    while total.relative_error(&scale) > tolerance.relative
        && parts.len() < tolerance.max_part_count
    {
        let Some((_, worst)) = worst_first.pop() else {
            break;
        };
        total.add(&parts[worst].1, -1.0);
        for (k, region) in split(&parts[worst].0).into_iter().enumerate() {
            let part = estimated(region);
            total.add(&part.1, 1.0);
            // The first takes the place of the whole.
            let index = if k == 0 { worst } else { parts.len() };
            worst_first.push((priority(&part.1, &scale), index));
            if k == 0 {
                parts[worst] = part
            } else {
                parts.push(part)
            }
        }
        scale = total.scale();
    }
    // Summed again: the running total carries the rounding of all parts added and removed.
    let mut sum = Estimate::ZERO;
    parts
        .iter()
        .for_each(|(_, estimate)| sum.add(estimate, 1.0));
    sum
}

/// Gauss-Legendre nodes along each side of a region.
pub const NODE_COUNT: usize = 6;
/// Positions along each side where an interpolant is checked. The ends, outside the nodes, are
/// worst.
const CHECKS: [f64; 3] = [-1.0, 0.0, 1.0];

/// Interpolates on a rectangle by values at the tensor Gauss-Legendre nodes, and checks the
/// interpolant.
#[derive(Clone, Debug, PartialEq)]
pub struct TensorRule {
    pub gauss: GaussLegendre<NODE_COUNT>,
    lagrange_at_checks: [[f64; NODE_COUNT]; CHECKS.len()],
}

impl Default for TensorRule {
    fn default() -> Self {
        let gauss = GaussLegendre::new();
        Self {
            lagrange_at_checks: CHECKS.map(|x| gauss.lagrange(x)),
            gauss,
        }
    }
}

impl TensorRule {
    /// Returns the coordinates in [-1, 1] of [`TensorRule::evaluate`]: the nodes, then the checks.
    pub fn coordinates(&self) -> [f64; NODE_COUNT + CHECKS.len()] {
        std::array::from_fn(|k| {
            if k < NODE_COUNT {
                self.gauss.nodes[k]
            } else {
                CHECKS[k - NODE_COUNT]
            }
        })
    }

    /// Returns the values of `K` functions at the nodes, and the largest error of each interpolant
    /// at the checks.
    ///
    /// `f(i, j)` gives the functions at coordinates i and j of the sides (see
    /// [`TensorRule::coordinates`]).
    pub fn evaluate<const K: usize>(
        &self,
        f: impl Fn(usize, usize) -> [f64; K],
    ) -> ([Line<K>; NODE_COUNT], [f64; K]) {
        let mut values = [[[0.0; K]; NODE_COUNT]; NODE_COUNT];
        (0..NODE_COUNT).for_each(|i| (0..NODE_COUNT).for_each(|j| values[i][j] = f(i, j)));
        let mut residual = [0.0_f64; K];
        let mut column = [[0.0; K]; NODE_COUNT];
        for (b, along_second) in self.lagrange_at_checks.iter().enumerate() {
            (0..NODE_COUNT).for_each(|i| column[i] = combine(along_second, &values[i]));
            for (a, along_first) in self.lagrange_at_checks.iter().enumerate() {
                let found = f(NODE_COUNT + a, NODE_COUNT + b);
                let interpolated = combine(along_first, &column);
                (0..K).for_each(|k| {
                    residual[k] = residual[k].max((found[k] - interpolated[k]).abs())
                });
            }
        }
        (values, residual)
    }
}

type Line<const K: usize> = [[f64; K]; NODE_COUNT];

fn combine<const K: usize>(weights: &[f64; NODE_COUNT], values: &Line<K>) -> [f64; K] {
    let mut sum = [0.0; K];
    (0..NODE_COUNT).for_each(|i| (0..K).for_each(|k| sum[k] += weights[i] * values[i][k]));
    sum
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    pub low: DVec2,
    pub high: DVec2,
}

impl Rectangle {
    /// Splits into the four quarters about `middle`.
    pub fn split_at(&self, middle: DVec2) -> [Self; 4] {
        let Self { low, high } = *self;
        [
            Self { low, high: middle },
            Self {
                low: DVec2::new(middle.x, low.y),
                high: DVec2::new(high.x, middle.y),
            },
            Self {
                low: DVec2::new(low.x, middle.y),
                high: DVec2::new(middle.x, high.y),
            },
            Self { low: middle, high },
        ]
    }

    pub fn center(&self) -> DVec2 {
        0.5 * (self.low + self.high)
    }
}

/// Integrates `f(column(x), y)` over a rectangle: `column` is computed once for all y of a part.
/// Kinks and cliffs cost time, not accuracy.
///
/// The error of a part is its area times the largest residual of its interpolant: pessimistic for
/// smooth parts.
pub fn integrate_columns<C>(
    rectangle: Rectangle,
    tolerance: Tolerance,
    column: impl Fn(f64) -> C,
    f: impl Fn(&C, f64) -> DVec3,
) -> Bounded {
    let rule = TensorRule::default();
    let coordinates = rule.coordinates();
    let estimate = |part: &Rectangle| {
        let center = part.center();
        let half = 0.5 * (part.high - part.low);
        let columns = coordinates.map(|x| column(center.x + half.x * x));
        let (values, residual) =
            rule.evaluate(|i, j| f(&columns[i], center.y + half.y * coordinates[j]).to_array());
        let weights = &rule.gauss.weights;
        let mean = DVec3::from(combine(
            weights,
            &values.map(|column| combine(weights, &column)),
        ));
        let area = half.x * half.y;
        Estimate {
            value: [area * mean],
            error: [4.0 * area * DVec3::from(residual)],
        }
    };
    // Sixteen roots: a single one could miss a feature between its nodes.
    let quarters = |part: &Rectangle| part.split_at(part.center());
    let roots = quarters(&rectangle)
        .into_iter()
        .flat_map(|part| quarters(&part));
    integrate_adaptively(roots, estimate, quarters, tolerance).combine([DVec3::ONE])
}
