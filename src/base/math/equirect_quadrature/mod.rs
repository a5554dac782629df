//! Integrals `∫ L(l) k(l) dl` of a bilinear equirectangular map L against a smooth kernel k, with
//! an error bound.
//!
//! The map is the rough factor (one texel may be a sun of 7e4 beside 0.1), the kernel the smooth
//! one. So the map is integrated exactly, once, and only the kernel is approximated: on a rectangle
//! R of the (u, v) plane, by the polynomial through its values at the tensor Gauss-Legendre nodes
//! `x_ij`:
//!
//! `∫_R L k dω ≈ Σ k(x_ij) W_ij`, `W_ij = ∫_R L ℓ_i(u) ℓ_j(v) dω`, `dω = 2π² sin(π v) du dv`,
//!
//! with `ℓ` the Lagrange polynomials of the nodes. The error is at most `max |k - polynomial| · ∫_R
//! |L| dω`; the maximum is estimated at corners, edge middles and centre of R, where an interpolant
//! through Gauss nodes is worst. A quadtree holds the weights W of blocks of texels; a parent's
//! follow from its children's, since its `ℓ` restricted to a child is a polynomial of the same
//! degree. Weights of smaller rectangles, down to parts of one bilinear cell, are computed on
//! demand.

mod tree;

use super::equirect::{direction_from_uv, uv_from_direction};
use super::quadrature::{Estimate, NODE_COUNT, TensorRule, Tolerance, integrate_adaptively};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// Regions at the start are at most 1/8 of the width, so that no lobe of the hemisphere's size is
/// missed.
const ROOT_WIDTH: f64 = 0.125;

/// `W_ij` of a region, three channels.
type Weights = [[DVec3; NODE_COUNT]; NODE_COUNT];

/// A rectangle of the (u, v) plane in texels: x in [-1/2, W - 1/2], y in [-1/2, H - 1/2], centres
/// at integers.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Region {
    low: DVec2,
    high: DVec2,
    /// Index of the tree's node with this rectangle, if any.
    node: Option<usize>,
}

#[derive(Clone, Debug)]
struct Node {
    weights: Weights,
    mass: DVec3,
    /// Regions of the children; empty for a leaf.
    children: Vec<Region>,
}

/// A direction about which a kernel is narrow: regions near it are split down to `radius` before
/// errors are estimated.
#[derive(Clone, Copy)]
pub struct Focus<'a> {
    pub direction: DVec3,
    /// Angular width of the feature where it is narrowest, radians.
    pub radius: f64,
    /// Of a feature that is not round: the place of a direction in a plane, in widths from the
    /// feature's centre, and its height above the horizon. Regions that the feature may reach are
    /// split down to its width there.
    pub in_widths: Option<&'a dyn Fn(DVec3) -> DVec3>,
}

/// Widths from the centre to the end of a feature: a Gaussian is 5e-6 there. And from the centre of
/// a region to its corners.
const FEATURE_END: f64 = 3.5;
const FEATURE_REACH: f64 = 2.0;

/// An equirectangular map prepared for integrals against many kernels.
#[derive(Clone, Debug)]
pub struct EquirectQuadrature {
    width: usize,
    height: usize,
    texels: Vec<[f32; 3]>,
    rule: TensorRule,
    nodes: Vec<Node>,
    root: Region,
}

impl EquirectQuadrature {
    /// Prepares a map of `width` x `height` texels (row 0 at +y). Takes about 1 kB per leaf of 36
    /// to 144 texels.
    pub fn new(width: u32, height: u32, texel: impl Fn(u32, u32) -> [f32; 3]) -> Self {
        let mut texels = Vec::with_capacity(width as usize * height as usize);
        texels.extend(
            (0..height)
                .flat_map(|y| (0..width).map(move |x| (x, y)))
                .map(|(x, y)| texel(x, y)),
        );
        let width = width as usize;
        let height = height as usize;
        let root = Region {
            low: DVec2::splat(-0.5),
            high: DVec2::new(width as f64 - 0.5, height as f64 - 0.5),
            node: None,
        };
        let mut quadrature = Self {
            width,
            height,
            texels,
            rule: TensorRule::default(),
            nodes: Vec::new(),
            root,
        };
        quadrature.nodes.reserve_exact(quadrature.node_count(&root));
        quadrature.root = quadrature.build(root);
        quadrature
    }

    pub fn radiance(&self, direction: DVec3) -> DVec3 {
        let place =
            uv_from_direction(direction) * DVec2::new(self.width as f64, self.height as f64) - 0.5;
        let corner = place.floor();
        let t = place - place.floor();
        let texel = |x: f64, y: f64| {
            let x = (corner.x + x).rem_euclid(self.width as f64) as usize;
            let y = (corner.y + y).clamp(0.0, self.height as f64 - 1.0) as usize;
            DVec3::from(self.texels[y * self.width + x].map(f64::from))
        };
        texel(0.0, 0.0)
            .lerp(texel(1.0, 0.0), t.x)
            .lerp(texel(0.0, 1.0).lerp(texel(1.0, 1.0), t.x), t.y)
    }

    /// Integrates `∫ L k dl` for `K` kernels at once; `error` bounds each number. Kinks cost time.
    pub fn integrate<const K: usize>(
        &self,
        kernel: impl Fn(DVec3) -> [f64; K],
        focus: Option<Focus>,
        tolerance: Tolerance,
    ) -> Estimate<K> {
        let mut roots = Vec::new();
        let mut pending = vec![self.root];
        while let Some(region) = pending.pop() {
            // A focus narrower than rounding would be split forever; the error bound covers the
            // rest.
            if roots.len() + pending.len() < tolerance.max_part_count
                && self.must_split(&region, focus.as_ref())
            {
                pending.extend(self.split_towards_square(&region));
            } else {
                roots.push(region);
            }
        }
        integrate_adaptively(
            roots,
            |region| self.estimate(region, &kernel),
            |region| self.split(region),
            tolerance,
        )
    }

    fn must_split(&self, region: &Region, focus: Option<&Focus>) -> bool {
        let size = self.uv(region.high) - self.uv(region.low);
        if size.x > ROOT_WIDTH {
            return true;
        }
        let diagonal = self.extent(region).length();
        let center = direction_from_uv(self.uv(0.5 * (region.low + region.high)));
        focus.is_some_and(|focus| {
            diagonal > focus.radius
                && center.angle_between(focus.direction) < focus.radius + 0.5 * diagonal
                || focus
                    .in_widths
                    .is_some_and(|place| self.is_too_wide(region, place))
        })
    }

    /// Whether all nodes of a region could miss a feature in it.
    fn is_too_wide(&self, region: &Region, in_widths: &dyn Fn(DVec3) -> DVec3) -> bool {
        let value = |x, y| {
            in_widths(direction_from_uv(
                self.uv(region.low + DVec2::new(x, y) * (region.high - region.low)),
            ))
        };
        let center = value(0.5, 0.5);
        let corners = [
            value(0.0, 0.0),
            value(1.0, 0.0),
            value(0.0, 1.0),
            value(1.0, 1.0),
        ];
        let reach = corners
            .map(|corner| corner.truncate().distance(center.truncate()))
            .into_iter()
            .fold(0.0, f64::max);
        let is_above = center.z > 0.0 || corners.iter().any(|corner| corner.z > 0.0);
        is_above && reach > FEATURE_REACH && center.truncate().length() < 1.5 * reach + FEATURE_END
    }

    /// Angular width and height of a region, radians.
    fn extent(&self, region: &Region) -> DVec2 {
        let size = self.uv(region.high) - self.uv(region.low);
        let middle = self.uv(0.5 * (region.low + region.high));
        // The widest row of a region, within half its height of the middle, bounds its width.
        let widest = (PI * ((middle.y - 0.5).abs() - 0.5 * size.y).max(0.0)).cos();
        PI * DVec2::new(2.0 * size.x * widest, size.y)
    }

    /// Splits a region into parts closer to squares on the sphere: at poles, quarters would become
    /// needles.
    fn split_towards_square(&self, region: &Region) -> Vec<Region> {
        let has_children = region
            .node
            .is_some_and(|index| !self.nodes[index].children.is_empty());
        let DVec2 {
            x: width,
            y: height,
        } = self.extent(region);
        let is_narrow =
            self.uv(region.high).x - self.uv(region.low).x <= ROOT_WIDTH && width < 0.5 * height;
        if has_children || !is_narrow {
            return self.split(region);
        }
        let y = middle_knot(region.low.y, region.high.y);
        let upper = Region {
            high: DVec2::new(region.high.x, y),
            node: None,
            ..*region
        };
        vec![
            upper,
            Region {
                low: DVec2::new(region.low.x, y),
                node: None,
                ..*region
            },
        ]
    }

    /// Splits a region into quarters, along the edges of bilinear cells if it has several.
    fn split(&self, region: &Region) -> Vec<Region> {
        if let Some(node) = region.node.map(|index| &self.nodes[index])
            && !node.children.is_empty()
        {
            return node.children.clone();
        }
        let Region { low, high, .. } = *region;
        let x = [low.x, middle_knot(low.x, high.x), high.x];
        let y = [low.y, middle_knot(low.y, high.y), high.y];
        let part = |i: usize, j: usize| Region {
            low: DVec2::new(x[i], y[j]),
            high: DVec2::new(x[i + 1], y[j + 1]),
            node: None,
        };
        vec![part(0, 0), part(1, 0), part(0, 1), part(1, 1)]
    }

    fn estimate<const K: usize>(
        &self,
        region: &Region,
        kernel: &impl Fn(DVec3) -> [f64; K],
    ) -> Estimate<K> {
        // Sines and cosines by row and column: a region has 81 points but only 18 angles.
        let coordinates = self.rule.coordinates();
        let low = self.uv(region.low);
        let high = self.uv(region.high);
        let coordinate = |low: f64, high: f64, x: f64| 0.5 * (low + high) + 0.5 * (high - low) * x;
        let azimuths =
            coordinates.map(|x| (2.0 * PI * (0.5 - coordinate(low.x, high.x, x))).sin_cos());
        let polar = coordinates.map(|x| (PI * coordinate(low.y, high.y, x)).sin_cos());
        let (values, residual) = self.rule.evaluate(|i, j| {
            let (sin_phi, cos_phi) = azimuths[i];
            let (sin_theta, cos_theta) = polar[j];
            kernel(DVec3::new(
                sin_phi * sin_theta,
                cos_theta,
                cos_phi * sin_theta,
            ))
        });
        if values
            .iter()
            .flatten()
            .chain([&residual])
            .flatten()
            .all(|&value| value == 0.0)
        {
            return Estimate {
                value: [DVec3::ZERO; K],
                error: [DVec3::ZERO; K],
            };
        }
        let computed;
        let (weights, mass) = match region.node {
            Some(index) => (&self.nodes[index].weights, self.nodes[index].mass),
            None => {
                computed = self.weights(region);
                (&computed.0, computed.1)
            }
        };
        let mut value = [DVec3::ZERO; K];
        for (weight, kernels) in weights.iter().flatten().zip(values.iter().flatten()) {
            for k in 0..K {
                value[k] += *weight * kernels[k];
            }
        }
        Estimate {
            value,
            error: residual.map(|residual| mass * residual),
        }
    }

    fn uv(&self, texel: DVec2) -> DVec2 {
        (texel + 0.5) / DVec2::new(self.width as f64, self.height as f64)
    }
}

/// Returns the edge of bilinear cells nearest to the middle of an interval, or the middle if no
/// edge is inside.
fn middle_knot(low: f64, high: f64) -> f64 {
    let knot = (0.5 * (low + high)).round();
    if knot > low && knot < high {
        knot
    } else {
        0.5 * (low + high)
    }
}
