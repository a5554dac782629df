//! Compares a specular method with the exact lobe, by its response to four lights of known truth.
//!
//! A method averages the light with a kernel K: its radiance is `∫ K(l) L(l) dl`. Light that is the
//! same everywhere gives `∫ K`, the gain. Light that grows linearly along x, y or z gives the first
//! moment `m = ∫ K l dl / ∫ K dl`: its direction is where the method looks, its length how widely.
//! A length is stated as the alpha of the level of a prefiltered map that has it. The lobe has the
//! same numbers, by quadrature in f64.

use super::fit::Gain;
use crate::base::math::design::frame;
use crate::base::math::equirect::direction_from_uv;
use crate::base::pixels::Pixels;
use crate::instrument::brdf::MaskingShadowing;
use crate::instrument::environment::Environment;
use crate::instrument::pipeline::{Pipeline, PipelineError, RenderRequest};
use crate::instrument::precompute::PrecomputeSettings;
use crate::instrument::precompute::prefilter::{Kernel, harmonic};
use crate::instrument::precompute::taps::Lobe;
use crate::instrument::scene::{CameraKind, MaterialOverride, Scene};
use crate::instrument::shade::{Method, Shading};
use glam::{DVec2, DVec3};
use serde::Serialize;
use std::path::Path;
use std::sync::Arc;

/// Widths of the surfaces: of the levels 1 to 4 of a map of five, so that no lookup blends two.
pub const ALPHAS: [f64; 4] = [0.0625, 0.25, 0.5625, 1.0];
/// F0 of the surfaces: a white metal, and what most dielectrics have.
pub const F0: [f64; 2] = [1.0, 0.04];
/// Side of the map's faces: lookups of the last level are within 0.1 % and 0.1 degrees, 0.4 at
/// corners of the cube.
const MAP_SIDE: u32 = 512;
/// Width and height of the lights.
const LIGHT_SIZE: [u32; 2] = [512, 256];
/// Side of the image: each pixel is a view, with n·v spread evenly.
const SIDE: u32 = 8;
/// Growth of light from the centre to 1 along an axis; light stays positive.
const SLOPE: f64 = 0.5;

/// First moments of a method that ignores the light are shorter; the widest kernel of a map has
/// 2/3.
const MOMENT_MIN: f64 = 0.05;
/// Range of widths that a first moment is compared with, alpha.
const ALPHA_RANGE: [f64; 2] = [0.001, 1.0];

/// An error of a method at one view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// Relative error of the gain.
    Gain,
    /// Relative error of alpha.
    Width,
    /// Angle between the first moments, degrees.
    Direction,
}

impl ErrorKind {
    pub const ALL: [Self; 3] = [Self::Gain, Self::Width, Self::Direction];

    /// Returns the largest median of a good method.
    pub fn limit(self) -> f64 {
        match self {
            Self::Gain => 0.03,
            Self::Width => 0.1,
            Self::Direction => 5.0,
        }
    }

    /// Returns the factor to the printed unit: percent or degrees.
    pub fn scale(self) -> f64 {
        match self {
            Self::Gain | Self::Width => 100.0,
            Self::Direction => 1.0,
        }
    }
}

/// A value for each error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PerError<T> {
    pub gain: T,
    pub width: T,
    pub direction: T,
}

impl<T: Copy> PerError<T> {
    pub fn get(&self, kind: ErrorKind) -> T {
        match kind {
            ErrorKind::Gain => self.gain,
            ErrorKind::Width => self.width,
            ErrorKind::Direction => self.direction,
        }
    }
}

/// A method at one view, compared with the lobe.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct View {
    pub n_dot_v: f64,
    /// Length of the kernel's first moment, from 0 (the light has no effect) to 1 (one direction is
    /// read).
    pub moment: f64,
    /// Relative errors of gain and `alpha`, and the angle between the first moments, degrees;
    /// positive towards the mirror direction, negative towards the normal.
    pub errors: PerError<f64>,
    /// Alpha of the level as wide as the method's kernel.
    pub alpha: f64,
    /// The alpha nearest to it, from the surface's to the alpha of the level as wide as the lobe.
    pub right_alpha: f64,
}

/// The views of one surface.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    pub alpha: f64,
    pub f0: f64,
    pub views: Vec<View>,
}

impl Row {
    /// Returns the views with the median and the largest of an error.
    pub fn ranked(&self, kind: ErrorKind) -> [&View; 2] {
        let size = |view: &View| view.errors.get(kind).abs();
        let mut views: Vec<&View> = self.views.iter().collect();
        views.sort_by(|a, b| size(a).total_cmp(&size(b)));
        [views[views.len() / 2], views[views.len() - 1]]
    }

    /// Returns the view with the median of an error.
    pub fn median(&self, kind: ErrorKind) -> &View {
        self.ranked(kind)[0]
    }

    fn median_size(&self, kind: ErrorKind) -> f64 {
        self.median(kind).errors.get(kind).abs()
    }
}

/// The largest median of an error over the surfaces.
#[derive(Clone, Copy, Debug)]
pub struct WorstError {
    pub kind: ErrorKind,
    /// Without its sign.
    pub size: f64,
    pub location: WorstLocation,
}

/// Where an error is largest.
#[derive(Clone, Copy, Debug)]
pub enum WorstLocation {
    /// A gain that is the same on every surface.
    EverySurface(Gain),
    Surface {
        alpha: f64,
        f0: f64,
        /// The view with the median.
        view: View,
        /// Smallest median over the surfaces, if all of them err much.
        least: Option<f64>,
    },
}

impl WorstError {
    /// Finds the surface with the largest median.
    pub fn new(rows: &[Row], kind: ErrorKind) -> Self {
        let mut sorted: Vec<&Row> = rows.iter().collect();
        sorted.sort_by(|a, b| a.median_size(kind).total_cmp(&b.median_size(kind)));
        let least_row = sorted[0];
        let row = sorted[rows.len() - 1];
        let least = least_row.median_size(kind);
        let size = row.median_size(kind);
        let limit = kind.limit();
        let gain = |row: &Row| 1.0 + row.median(ErrorKind::Gain).errors.gain;
        let is_even = (gain(least_row) / gain(row) - 1.0).abs() < limit;
        let location = if kind == ErrorKind::Gain && size > limit && is_even {
            WorstLocation::EverySurface(Gain::new(gain(row)))
        } else {
            WorstLocation::Surface {
                alpha: row.alpha,
                f0: row.f0,
                view: *row.median(kind),
                least: (least > limit.max(0.5 * size)).then_some(least),
            }
        };
        Self {
            kind,
            size,
            location,
        }
    }

    /// Whether it is above the limit of a good method.
    pub fn is_fault(&self) -> bool {
        self.size > self.kind.limit()
    }
}

/// How good a method is.
#[derive(Clone, Debug)]
pub enum ShaderVerdict {
    /// Largest medians of the errors.
    Good(PerError<f64>),
    /// Errors above their limits.
    Wrong(Vec<WorstError>),
    /// The light's direction has no effect.
    WithoutLight,
}

impl ShaderVerdict {
    /// Compares the largest medians with their limits.
    pub fn new(rows: &[Row]) -> Self {
        let mut views = rows.iter().flat_map(|row| &row.views);
        if views.all(|view| view.moment < MOMENT_MIN) {
            return Self::WithoutLight;
        }
        let [gain, width, direction] = ErrorKind::ALL.map(|kind| WorstError::new(rows, kind));
        let sizes = PerError {
            gain: gain.size,
            width: width.size,
            direction: direction.size,
        };
        let faults: Vec<WorstError> = [gain, width, direction]
            .into_iter()
            .filter(WorstError::is_fault)
            .collect();
        if faults.is_empty() {
            Self::Good(sizes)
        } else {
            Self::Wrong(faults)
        }
    }

    pub fn is_good(&self) -> bool {
        matches!(self, Self::Good(_))
    }
}

/// Renders a method under every light, and compares each view with the lobe of GGX.
pub fn check(
    pipeline: &mut Pipeline,
    method: &'static Method,
    masking_shadowing: MaskingShadowing,
) -> Result<Vec<Row>, PipelineError> {
    let precompute = PrecomputeSettings {
        prefilter_size: [MAP_SIDE; 2],
        ..PrecomputeSettings::default()
    };
    let shading = Shading {
        method,
        masking_shadowing,
        precompute,
        ..Shading::default()
    };
    let even = light("even", 0.0);
    let slope = light("slope", SLOPE);
    let mut rows = Vec::new();
    for alpha in ALPHAS {
        for f0 in F0 {
            let even = render(pipeline, shading, &even, alpha, f0)?;
            let slope = render(pipeline, shading, &slope, alpha, f0)?;
            let views = (0..)
                .zip(even.iter().zip(&slope))
                .map(|(index, (even, slope))| {
                    let [n, v] = frame(index, SIDE * SIDE);
                    let surface = Surface { alpha, f0, n, v };
                    let gain = even.element_sum() / 3.0;
                    surface.view(&shading, gain, (*slope / *even - 1.0) / SLOPE)
                })
                .collect();
            rows.push(Row { alpha, f0, views });
        }
    }
    Ok(rows)
}

/// Makes a light of `1 + slope * l` in the channels.
fn light(name: &str, slope: f64) -> Arc<Environment> {
    let [width, height] = LIGHT_SIZE;
    let size = DVec2::new(width.into(), height.into());
    let radiance = |x: u32, y: u32| {
        let uv = (DVec2::new(x.into(), y.into()) + 0.5) / size;
        (1.0 + slope * direction_from_uv(uv)).as_vec3().to_array()
    };
    let image = Pixels::from_fn(width, height, radiance);
    Arc::new(Environment::from_image(name, image))
}

/// Renders the views of a surface.
fn render(
    pipeline: &mut Pipeline,
    shading: Shading,
    light: &Arc<Environment>,
    alpha: f64,
    f0: f64,
) -> Result<Vec<DVec3>, PipelineError> {
    let material = MaterialOverride {
        alpha: Some(alpha as f32),
        f0: Some([f0 as f32; 3]),
        ..MaterialOverride::default()
    };
    let scene = Scene::load("design", Path::new(""))
        .expect("a built-in scene")
        .apply(&material);
    let request = RenderRequest::plain(light.clone(), scene, CameraKind::Ortho, [SIDE; 2]);
    let frame = pipeline.render(&request.shaded(|shaded| *shaded = shading))?;
    let texel = |texel: &[f32; 3]| DVec3::from_array(texel.map(f64::from));
    Ok(frame.radiance.data.iter().map(texel).collect())
}

/// A surface at one view.
struct Surface {
    alpha: f64,
    f0: f64,
    n: DVec3,
    v: DVec3,
}

impl Surface {
    /// Compares gain and first moment of a method with the lobe's.
    fn view(&self, shading: &Shading, gain: f64, moment: DVec3) -> View {
        let Self { alpha, f0, n, v } = *self;
        let n_dot_v = n.dot(v);
        let lobe = Lobe::new(shading.brdf, shading.masking_shadowing, n_dot_v, alpha);
        let right_gain = f0 * lobe.albedos.x + lobe.albedos.y;
        let [of_f0, of_f90] = lobe.moments();
        let shares = of_f0.lerp(of_f90, lobe.albedos.y / right_gain);
        let r = 2.0 * n_dot_v * n - v;
        let right = shares.x * r + shares.y * n;
        // Without light in a channel there is no moment, and the gain tells.
        let moment = if moment.is_finite() { moment } else { right };
        // From the normal, in the plane of incidence.
        let angle = |m: DVec3| m.dot((r - n_dot_v * n).normalize()).atan2(m.dot(n));
        let between = moment.cross(right).length().atan2(moment.dot(right));
        let kernel = Kernel::cosine(shading.brdf);
        let found_alpha = alpha_of(kernel, moment.length());
        let lobe_alpha = alpha_of(kernel, right.length());
        let right_alpha = found_alpha.clamp(alpha.min(lobe_alpha), alpha.max(lobe_alpha));
        View {
            n_dot_v,
            moment: moment.length(),
            errors: PerError {
                gain: gain / right_gain - 1.0,
                width: found_alpha / right_alpha - 1.0,
                direction: between.to_degrees().copysign(angle(moment) - angle(right)),
            },
            alpha: found_alpha,
            right_alpha,
        }
    }
}

/// Returns the alpha, from 0.001 to 1, of the level whose first moment has that length.
fn alpha_of(kernel: Kernel, length: f64) -> f64 {
    let [mut low, mut high] = ALPHA_RANGE;
    for _ in 0..24 {
        let middle = (low * high).sqrt();
        if harmonic::factors(kernel, middle, 1)[1] < length {
            high = middle;
        } else {
            low = middle;
        }
    }
    high
}
