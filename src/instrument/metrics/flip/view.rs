//! One image as FLIP sees it: filtered colours, edges and points.

use super::PIXELS_PER_DEGREE;
use crate::base::color::{Chromaticities, REC709, srgb_decode};
use crate::base::pixels::Rgb8Image;
use crate::instrument::metrics::filter::Plane;
use glam::{DMat3, DVec2, Mat3, Vec3};
use std::f64::consts::PI;
use std::sync::LazyLock;

/// D65 as in the authors' program, with four digits.
const WHITE: DVec2 = DVec2::new(0.312_71, 0.329_02);

/// Contrast sensitivity (luminance, red to green, blue to yellow), table 1: the sum of `a √(π / b)
/// exp(-π² r² / b)` over pairs `(a, b)`, `r` in degrees.
const SENSITIVITY: [&[(f64, f64)]; 3] = [
    &[(1.0, 0.0047)],
    &[(1.0, 0.0053)],
    &[(34.1, 0.04), (13.5, 0.025)],
];

/// Width of edges and points, degrees: section 4.2; twice the Gaussian's standard deviation.
const FEATURE_WIDTH: f64 = 0.082;

#[derive(Debug)]
pub(in crate::instrument::metrics) struct View {
    height: usize,
    /// Hunt-adjusted L*a*b* after filtering.
    lab: [Plane; 3],
    /// Magnitudes of the first and second derivatives of luminance.
    features: [Plane; 2],
}

impl View {
    /// Filters an image, continued by its outermost pixels.
    pub fn new(image: &Rgb8Image) -> Self {
        let width = image.width as usize;
        let len = image.data.len();
        let opponent: Vec<Vec3> = image
            .data
            .iter()
            .map(|&rgb| opponent(to_xyz(linear(rgb))))
            .collect();
        let channels: [Plane; 3] =
            std::array::from_fn(|c| Plane::from_fn(width, len, |pixel| opponent[pixel][c]));
        drop(opponent);
        let features = features(&channels[0]);
        let mut lab: [Plane; 3] =
            std::array::from_fn(|c| filtered(&channels[c], &SENSITIVITY_TAPS[c]));
        drop(channels);
        for pixel in 0..len {
            let color = hunt_lab(Vec3::from_array(
                lab.each_ref().map(|plane| plane.data[pixel]),
            ));
            lab.iter_mut()
                .zip(color)
                .for_each(|(plane, value)| plane.data[pixel] = value);
        }
        Self {
            height: image.height as usize,
            lab,
            features,
        }
    }

    pub fn size(&self) -> [u32; 2] {
        [self.lab[0].width as u32, self.height as u32]
    }

    pub fn lab(&self, pixel: usize) -> [f32; 3] {
        self.lab.each_ref().map(|plane| plane.data[pixel])
    }

    /// Returns the larger difference in edges or points, in [0, 1].
    pub fn feature_difference(&self, other: &Self, pixel: usize) -> f32 {
        let difference =
            |i: usize| (self.features[i].data[pixel] - other.features[i].data[pixel]).abs();
        (difference(0).max(difference(1)) * std::f32::consts::FRAC_1_SQRT_2).min(1.0)
    }
}

/// Converts a colour without filtering.
pub(super) fn flat_lab(rgb: [u8; 3]) -> [f32; 3] {
    hunt_lab(opponent(to_xyz(linear(rgb))))
}

fn linear(rgb: [u8; 3]) -> Vec3 {
    static DECODED: LazyLock<[f32; 256]> =
        LazyLock::new(|| std::array::from_fn(|i| srgb_decode(i as f32 / 255.0)));
    Vec3::from_array(rgb.map(|code| DECODED[usize::from(code)]))
}

/// Matrices from linear RGB to XYZ with white at (1, 1, 1), and back.
static RELATIVE_XYZ: LazyLock<[Mat3; 2]> = LazyLock::new(|| {
    let space = Chromaticities {
        white: WHITE,
        ..REC709
    };
    let to_xyz = space
        .to_xyz()
        .expect("the primaries of Rec.709 span a triangle around D65");
    let relative = DMat3::from_diagonal(to_xyz * glam::DVec3::ONE).inverse() * to_xyz;
    [relative, relative.inverse()].map(|matrix| matrix.as_mat3())
});

fn to_xyz(rgb: Vec3) -> Vec3 {
    RELATIVE_XYZ[0] * rgb
}

/// Returns `Y C_x C_z`, the linear form of L*a*b*, which may be averaged.
fn opponent(xyz: Vec3) -> Vec3 {
    Vec3::new(
        116.0 * xyz.y - 16.0,
        500.0 * (xyz.x - xyz.y),
        200.0 * (xyz.y - xyz.z),
    )
}

/// Clips an opponent colour to the monitor; returns L*a*b* with chroma scaled by lightness (Hunt:
/// section 4.1).
fn hunt_lab(opponent: Vec3) -> [f32; 3] {
    let y = (opponent.x + 16.0) / 116.0;
    let xyz = Vec3::new(y + opponent.y / 500.0, y, y - opponent.z / 200.0);
    let shown = (RELATIVE_XYZ[1] * xyz).clamp(Vec3::ZERO, Vec3::ONE);
    let [x, y, z] = to_xyz(shown).to_array().map(|t| {
        const DELTA: f32 = 6.0 / 29.0;
        if t > DELTA * DELTA * DELTA {
            t.cbrt()
        } else {
            t / (3.0 * DELTA * DELTA) + 4.0 / 29.0
        }
    });
    let lightness = 116.0 * y - 16.0;
    let chroma = 0.01 * lightness;
    [
        lightness,
        chroma * 500.0 * (x - y),
        chroma * 200.0 * (y - z),
    ]
}

/// Taps of a Gaussian of [`SENSITIVITY`] along one axis.
type Taps = Vec<f32>;

/// Gaussians of each channel; their weights sum to 1.
static SENSITIVITY_TAPS: LazyLock<[Vec<Taps>; 3]> = LazyLock::new(|| {
    let widest = SENSITIVITY
        .iter()
        .copied()
        .flatten()
        .map(|&(_, b)| b)
        .fold(0.0, f64::max);
    // Three standard deviations of the widest Gaussian.
    let radius =
        (3.0 * (widest / (2.0 * PI * PI)).sqrt() * f64::from(PIXELS_PER_DEGREE)).ceil() as i32;
    SENSITIVITY.map(|pairs| {
        let gaussian = |&(a, b): &(f64, f64)| -> Vec<f64> {
            // Both axes multiply, so each has the root.
            let height = (a * (PI / b).sqrt()).sqrt();
            let angle = |i: i32| f64::from(i) / f64::from(PIXELS_PER_DEGREE);
            (-radius..=radius)
                .map(|i| height * (-PI * PI * angle(i).powi(2) / b).exp())
                .collect()
        };
        let gaussians: Vec<Vec<f64>> = pairs.iter().map(gaussian).collect();
        let total: f64 = gaussians
            .iter()
            .map(|taps| taps.iter().sum::<f64>().powi(2))
            .sum();
        let normalized =
            |taps: &Vec<f64>| taps.iter().map(|tap| (tap / total.sqrt()) as f32).collect();
        gaussians.iter().map(normalized).collect()
    })
});

/// Filters a channel by its contrast sensitivity.
fn filtered(channel: &Plane, gaussians: &[Taps]) -> Plane {
    let blurred = |taps: &Taps| channel.filter_rows(taps).filter_columns(taps);
    let mut sum = blurred(&gaussians[0]);
    for taps in &gaussians[1..] {
        sum.data
            .iter_mut()
            .zip(blurred(taps).data)
            .for_each(|(sum, value)| *sum += value);
    }
    sum
}

/// Gaussian and its derivatives. The Gaussian's weights sum to 1, positive and negative weights of
/// the others to 1 and -1.
static FEATURE_TAPS: LazyLock<[Taps; 3]> = LazyLock::new(|| {
    let sigma = 0.5 * FEATURE_WIDTH * f64::from(PIXELS_PER_DEGREE);
    let radius = (3.0 * sigma).ceil() as i32;
    let taps = |factor: fn(f64) -> f64| -> Taps {
        let offset = |i: i32| f64::from(i) / sigma;
        let weights: Vec<f64> = (-radius..=radius)
            .map(|i| factor(offset(i)) * (-0.5 * offset(i).powi(2)).exp())
            .collect();
        let sum = |sign: f64| {
            weights
                .iter()
                .map(|weight| (sign * weight).max(0.0))
                .sum::<f64>()
        };
        let positive = sum(1.0);
        let negative = sum(-1.0);
        weights
            .iter()
            .map(|&w| {
                (if w > 0.0 {
                    w / positive
                } else {
                    w / negative.max(f64::MIN_POSITIVE)
                }) as f32
            })
            .collect()
    };
    [taps(|_| 1.0), taps(|t| -t), taps(|t| t * t - 1.0)]
});

/// Returns the lengths of first and second derivatives of luminance on [0, 1].
fn features(luminance: &Plane) -> [Plane; 2] {
    let [smooth, first, second] = &*FEATURE_TAPS;
    let across = luminance.filter_rows(smooth);
    [first, second].map(|derivative| {
        let mut along_x = luminance.filter_rows(derivative).filter_columns(smooth);
        let along_y = across.filter_columns(derivative);
        // 116 spans black to white; the offset cancels.
        along_x
            .data
            .iter_mut()
            .zip(along_y.data)
            .for_each(|(x, y)| *x = x.hypot(y) / 116.0);
        along_x
    })
}
