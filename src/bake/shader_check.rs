//! Compares a specular method with the exact lobe, by its response to four lights of known truth.
//!
//! A method averages the light with a kernel K: its radiance is `∫ K(l) L(l) dl`. Light that is the
//! same everywhere gives `∫ K`, the gain. Light that grows linearly along x, y or z gives the first
//! moment `m = ∫ K l dl / ∫ K dl`: its direction is where the method looks, its length how widely.
//! A length is stated as the alpha of the level of a prefiltered map that has it. The lobe has the
//! same numbers, by quadrature in f64.

use crate::bake::judge::gain_in_words;
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
use serde::{Serialize, Serializer};
use std::path::Path;
use std::sync::Arc;

/// Widths of the surfaces: of the levels 1 to 4 of a map of five, so that no lookup blends two.
pub const ALPHAS: [f64; 4] = [0.0625, 0.25, 0.5625, 1.0];
/// F0 of the surfaces: a white metal, and what most dielectrics have.
pub const F0: [f64; 2] = [1.0, 0.04];
/// Sides of the map's faces: lookups of the last level are within 0.1 % and 0.1 degrees, beside
/// corners of the cube 0.4.
const MAP_SIDE: u32 = 512;
/// Sides of the image: each pixel is a view, with n·v spread evenly.
const SIDE: u32 = 8;
/// Growth of light from the centre to 1 along an axis; light stays positive.
const SLOPE: f64 = 0.5;

/// The errors: name, largest median of a good method, unit in words, and what converts to that
/// unit.
pub const ERRORS: [(&str, f64, &str, f64); 3] = [
    ("gain", 0.03, "%", 100.0),
    ("width", 0.1, "%", 100.0),
    ("direction", 5.0, "degrees", 1.0),
];
/// First moments of a method that ignores the light are shorter; the widest kernel of a map has
/// 2/3.
const MOMENT_MIN: f64 = 0.05;

/// A method at one view, compared with the lobe.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct View {
    pub n_dot_v: f64,
    /// Length of the kernel's first moment, from 0 (the light has no effect) to 1 (one direction is
    /// read).
    pub moment: f64,
    /// Relative errors of gain and `alpha`, and the angle between the first moments, degrees;
    /// positive towards the mirror direction, negative towards the normal.
    #[serde(serialize_with = "by_name")]
    pub errors: [f64; 3],
    /// Alpha of the level as wide as the method's kernel.
    pub alpha: f64,
    /// The alpha nearest to it, from the surface's own to the alpha of the level as wide as the
    /// lobe.
    pub right_alpha: f64,
}

/// The views of one surface.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    pub alpha: f64,
    pub f0: f64,
    pub views: Vec<View>,
}

fn by_name<S: Serializer>(errors: &[f64; 3], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(ERRORS.iter().map(|own| own.0).zip(errors))
}

impl View {
    fn words(&self, error: usize) -> String {
        let (size, is_positive) = (self.errors[error].abs(), self.errors[error] > 0.0);
        let side = |positive, negative| if is_positive { positive } else { negative };
        match error {
            0 => format!("{:.1} % too {}", 100.0 * size, side("bright", "dark")),
            1 => {
                let side = side("blurred", "sharp");
                format!(
                    "the level is too {side} (as of alpha {:.2} for {:.2})",
                    self.alpha, self.right_alpha
                )
            }
            _ if size > 90.0 => format!(
                "looks away from the lobe, by {size:.1} degrees: check the signs of v and n"
            ),
            _ => format!(
                "direction {size:.1} degrees towards the {}",
                side("mirror direction", "normal")
            ),
        }
    }
}

impl Row {
    /// Returns the views with the median and the largest of an error, an index of [`ERRORS`].
    pub fn ranked(&self, error: usize) -> [&View; 2] {
        let mut views: Vec<&View> = self.views.iter().collect();
        views.sort_by(|a, b| a.errors[error].abs().total_cmp(&b.errors[error].abs()));
        [views[views.len() / 2], views[views.len() - 1]]
    }
}

/// Returns the largest median of an error over the rows without its sign, and it in words.
pub fn worst(rows: &[Row], error: usize) -> (f64, String) {
    let size = |row: &Row| row.ranked(error)[0].errors[error].abs();
    let mut sorted: Vec<&Row> = rows.iter().collect();
    sorted.sort_by(|a, b| size(a).total_cmp(&size(b)));
    let (least, row) = (size(sorted[0]), sorted[rows.len() - 1]);
    let (_, good, unit, scale) = ERRORS[error];
    let [gain_of_least, gain] = [sorted[0], row].map(|row| 1.0 + row.ranked(0)[0].errors[0]);
    if error == 0 && size(row) > good && (gain_of_least / gain - 1.0).abs() < good {
        return (
            size(row),
            format!("{} at every alpha and f0", gain_in_words(gain).0),
        );
    }
    let elsewhere = match least > good.max(0.5 * size(row)) {
        true => format!(
            " (at least {:.1} {unit} off at every alpha and f0)",
            scale * least
        ),
        false => String::new(),
    };
    (
        size(row),
        format!(
            "{} at alpha {}, f0 {}{elsewhere}",
            row.ranked(error)[0].words(error),
            row.alpha,
            row.f0
        ),
    )
}

/// Names the largest median of each error above its limit.
pub fn verdict(rows: &[Row]) -> String {
    if rows
        .iter()
        .flat_map(|row| &row.views)
        .all(|view| view.moment < MOMENT_MIN)
    {
        return "wrong: the light's direction has no effect; does the function look up the map?"
            .to_owned();
    }
    let worst = [0, 1, 2].map(|error| worst(rows, error));
    let faults = worst
        .iter()
        .zip(ERRORS)
        .filter(|((size, _), (_, good, ..))| size > good);
    let faults: Vec<&str> = faults.map(|((_, words), _)| words.as_str()).collect();
    let [gain, width, direction] = [0, 1, 2].map(|error| ERRORS[error].3 * worst[error].0);
    match faults.is_empty() {
        true => format!(
            "good: gain within {gain:.1} %, width {width:.1} %, direction {direction:.1} degrees"
        ),
        false => format!("wrong: {}", faults.join("; ")),
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
    let light = |name: &str, slope: f64| {
        let [width, height] = [512, 256];
        let radiance = |x: u32, y: u32| {
            let uv =
                (DVec2::new(x.into(), y.into()) + 0.5) / DVec2::new(width.into(), height.into());
            (1.0 + slope * direction_from_uv(uv)).as_vec3().to_array()
        };
        Arc::new(Environment::from_image(
            name,
            Pixels::from_fn(width, height, radiance),
        ))
    };
    let lights = [light("even", 0.0), light("slope", SLOPE)];
    let mut rows = Vec::new();
    for (alpha, f0) in ALPHAS
        .into_iter()
        .flat_map(|alpha| F0.map(|f0| (alpha, f0)))
    {
        let material = MaterialOverride {
            alpha: Some(alpha as f32),
            f0: Some([f0 as f32; 3]),
            ..MaterialOverride::default()
        };
        let scene = Scene::load("design", Path::new(""))
            .expect("a built-in scene")
            .apply(&material);
        let mut render = |light: &Arc<Environment>| {
            let request =
                RenderRequest::plain(light.clone(), scene.clone(), CameraKind::Ortho, [SIDE; 2]);
            pipeline
                .render(&request.shaded(|own| *own = shading))
                .map(|frame| frame.radiance.data)
        };
        let (even, slope) = (render(&lights[0])?, render(&lights[1])?);
        let wide = |texel: [f32; 3]| DVec3::from_array(texel.map(f64::from));
        let view = |(i, (even, slope)): (u32, (&[f32; 3], &[f32; 3]))| {
            let (even, slope) = (wide(*even), wide(*slope));
            view(
                &shading,
                [alpha, f0],
                frame(i, SIDE * SIDE),
                even.element_sum() / 3.0,
                (slope / even - 1.0) / SLOPE,
            )
        };
        rows.push(Row {
            alpha,
            f0,
            views: (0..).zip(even.iter().zip(&slope)).map(view).collect(),
        });
    }
    Ok(rows)
}

fn view(
    shading: &Shading,
    [alpha, f0]: [f64; 2],
    [n, v]: [DVec3; 2],
    gain: f64,
    moment: DVec3,
) -> View {
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
    let off = moment.cross(right).length().atan2(moment.dot(right));
    let [own, of_lobe] =
        [moment, right].map(|m| alpha_of(Kernel::cosine(shading.brdf), m.length()));
    let right_alpha = own.clamp(alpha.min(of_lobe), alpha.max(of_lobe));
    let direction = off.to_degrees().copysign(angle(moment) - angle(right));
    let errors = [gain / right_gain - 1.0, own / right_alpha - 1.0, direction];
    View {
        n_dot_v,
        moment: moment.length(),
        errors,
        alpha: own,
        right_alpha,
    }
}

/// Returns the alpha, from 0.001 to 1, of the level whose first moment has that length.
fn alpha_of(kernel: Kernel, length: f64) -> f64 {
    let (mut low, mut high) = (0.001_f64, 1.0);
    for _ in 0..24 {
        let middle = (low * high).sqrt();
        let is_wider = harmonic::factors(kernel, middle, 1)[1] < length;
        *(if is_wider { &mut high } else { &mut low }) = middle;
    }
    high
}
