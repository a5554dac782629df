//! Sequences of frames, each added on the host to a history of linear radiance.
//!
//! The history of a pixel is the weighted sum S of its signals and the sum W of their weights. A
//! frame of signal x gives
//!
//! ```text
//! S = q S' + x      W = q W' + 1      result S / W
//! ```
//!
//! S' and W' belong to the frame before, bilinear at the position where it saw the same surface;
//! pixels of another surface count 0 there, so W falls where a surface appears. The geometry is
//! known, so reprojection is exact up to the bilinear lookup. The signal is `(L - offset) / scale`;
//! offset and scale are 0 and 1 unless [`History`] says otherwise.

use super::reprojection::{Sums, View};
use super::request::{Frame, FrameTimings, Steadiness};
use super::{Pipeline, PipelineError, RenderRequest};
use crate::base::math::sequence::{FramePoints, PixelPoints, SEQUENCES, frame_shift};
use crate::base::names::Listed;
use crate::base::pixels::{GrayImage, Pixels, RgbImage};
use crate::instrument::environment::Environment;
use crate::instrument::metrics::tone_mapped_curve;
use crate::instrument::scene::Orbit;
use crate::instrument::shade::frames::{Frames, History, Motion};
use crate::instrument::shade::{Diffuse, Method, NONE};
use crate::instrument::tonemap::ToneCurve;
use glam::DVec3;
use std::sync::Arc;

/// Samples of the frames that stand for frames without noise; their points are the same in all
/// pixels and frames.
pub const CONVERGED_SAMPLES: u32 = 64;
/// Last frames that the flicker is about.
const FLICKER_FRAMES: u32 = 8;
/// Smallest divisor of a demodulated signal.
const SCALE_MIN: f64 = 1e-3;

impl RenderRequest {
    /// Whether the image ends a sequence of frames.
    pub(super) fn is_sequence(&self) -> bool {
        self.shading.frames.count > 1 && self.shading.frame.is_none()
    }

    /// Returns the request of one frame of the sequence; the last one has the pose of the request.
    pub fn of_frame(&self, index: u32) -> Self {
        let Frames {
            count,
            motion,
            motion_deg,
            ..
        } = self.shading.frames;
        let turn = -motion_deg * f64::from(count - 1 - index);
        let frame = self.shaded(|s| {
            s.frame = Some(index);
            s.placement.rotation_deg += if motion == Motion::Light { turn } else { 0.0 };
        });
        let orbit = Orbit {
            yaw_deg: if motion == Motion::Orbit { turn } else { 0.0 },
            ..Orbit::default()
        };
        Self {
            camera: frame.camera.orbited(orbit, &frame.scene),
            ..frame
        }
    }

    /// Returns the request of a frame without noise, with the same lookups.
    fn converged(&self) -> Self {
        self.shaded(|s| {
            s.lod_bias += 0.5 * (CONVERGED_SAMPLES as f32 / s.samples as f32).log2();
            s.frame = None;
            s.frames.count = 1;
            s.samples = CONVERGED_SAMPLES;
            s.sequence = &SEQUENCES[0];
            s.point_set = 0;
            s.pixel_points = PixelPoints::Shared;
        })
    }

    /// Returns the shift of each pixel's points, if the frame has one.
    pub(super) fn point_shifts(&self) -> Option<Vec<[u32; 2]>> {
        let [width, height] = self.size;
        let shading = &self.shading;
        let frame = shading
            .frame
            .filter(|_| shading.frames.points != FramePoints::Owen)?;
        let shift = |pixel| {
            frame_shift(
                shading.frames.points,
                pixel,
                frame,
                shading.samples,
                shading.point_set,
            )
        };
        Some(
            (0..height)
                .flat_map(|y| (0..width).map(move |x| [x, y]))
                .map(shift)
                .collect(),
        )
    }
}

/// A filter of one image per frame.
#[derive(Default)]
struct Filter {
    sums: Option<Sums>,
}

impl Filter {
    /// Adds a frame; returns the result, which off the surfaces is the frame itself.
    fn add(
        &mut self,
        frames: &Frames,
        view: &Arc<View>,
        transform: &SignalTransform,
        frame: &RgbImage,
    ) -> RgbImage {
        let signal =
            |index| (wide(frame, index) - transform.offset(index)) / transform.scale(index);
        let signal: Vec<DVec3> = (0..frame.data.len()).map(signal).collect();
        let sums = Sums::added(self.sums.as_ref(), frames, view, &signal);
        let radiance = |(index, mean): (usize, DVec3)| {
            let result = (transform.offset(index) + transform.scale(index) * mean).max(DVec3::ZERO);
            result.as_vec3().to_array()
        };
        let result = Pixels::new(
            frame.width,
            frame.height,
            sums.means().enumerate().map(radiance).collect(),
        );
        self.sums = Some(sums);
        result
    }
}

/// Makes the signal `(L - offset) / scale` of radiance L.
#[derive(Default)]
struct SignalTransform {
    /// `None` for 0.
    offset: Option<RgbImage>,
    /// `None` for 1.
    scale: Option<RgbImage>,
}

impl SignalTransform {
    fn offset(&self, pixel: usize) -> DVec3 {
        self.offset
            .as_ref()
            .map_or(DVec3::ZERO, |image| wide(image, pixel))
    }

    fn scale(&self, pixel: usize) -> DVec3 {
        self.scale.as_ref().map_or(DVec3::ONE, |image| {
            wide(image, pixel).max(DVec3::splat(SCALE_MIN))
        })
    }
}

fn wide(image: &RgbImage, pixel: usize) -> DVec3 {
    DVec3::from_array(image.data[pixel].map(f64::from))
}

/// What several frames share if nothing moves.
struct Pose {
    view: Arc<View>,
    transform: SignalTransform,
}

impl Pipeline {
    /// Renders and adds the frames of a sequence.
    pub(super) fn render_frames(
        &mut self,
        request: &RenderRequest,
    ) -> Result<Frame, PipelineError> {
        let frames = request.shading.frames;
        let is_moving = frames.motion != Motion::Still;
        let curve = tone_mapped_curve(request.epsilon());
        let mut filter = Filter::default();
        let mut filter_without_noise = Filter::default();
        let mut pose: Option<Pose> = None;
        let mut timings = FrameTimings::default();
        let mut last = None;
        // Of the last frames: the results less, under motion, the results without noise.
        let mut differences: Vec<Vec<DVec3>> = Vec::new();
        for index in 0..frames.count {
            let frame_request = request.of_frame(index);
            let frame = self.render(&frame_request)?;
            let frame_pose = match pose.take() {
                Some(pose) if !is_moving => pose,
                before => self.pose(&frame_request, before.as_ref())?,
            };
            let Pose { view, transform } = &frame_pose;
            let radiance = filter.add(&frames, view, transform, &frame.radiance);
            // A still view without noise is the same in every frame.
            let is_last = index + 1 == frames.count;
            let without_noise = if is_moving || is_last {
                let converged = self.render(&frame_request.converged())?.radiance;
                Some(if is_moving {
                    filter_without_noise.add(&frames, view, transform, &converged)
                } else {
                    converged
                })
            } else {
                None
            };
            timings = timings.and(frame.timings.clone());
            if index + FLICKER_FRAMES >= frames.count {
                let exact = without_noise.as_ref().filter(|_| is_moving);
                differences.push(shown_difference(&curve, &radiance, exact));
            }
            last = Some((Frame { radiance, ..frame }, without_noise));
            pose = Some(frame_pose);
        }
        let (frame, without_noise) = last.expect("a sequence has at least two frames");
        let flicker = flicker(&differences, &frame.mask);
        Ok(Frame {
            steadiness: without_noise.map(|without_noise| Steadiness {
                without_noise,
                flicker,
            }),
            timings,
            ..frame
        })
    }

    /// Returns the pose of a frame; the surfaces are the ones before if the camera stands
    /// still.
    fn pose(
        &mut self,
        request: &RenderRequest,
        before: Option<&Pose>,
    ) -> Result<Pose, PipelineError> {
        let known = before
            .filter(|pose| pose.view.camera == request.camera)
            .map(|pose| pose.view.surfaces.clone());
        let surfaces = match known {
            Some(surfaces) => surfaces,
            None => {
                let (_, target) = self.resources.view(&self.gpu, request)?;
                Arc::new(target.gbuffer.read_surfaces(&self.gpu)?)
            }
        };
        let view = View {
            camera: request.camera,
            environment_from_world: request.shading.placement.environment_from_world(),
            surfaces,
        };
        Ok(Pose {
            view: Arc::new(view),
            transform: self.signal_transform(request)?,
        })
    }

    /// Renders what the history of a request subtracts from radiance, or divides it by.
    fn signal_transform(
        &mut self,
        request: &RenderRequest,
    ) -> Result<SignalTransform, PipelineError> {
        let split_sum = request.shaded(|s| {
            s.method = Method::listed("split-sum");
            s.frame = None;
            s.frames = Frames::default();
        });
        Ok(match request.shading.frames.history {
            History::ControlVariate => SignalTransform {
                offset: Some(self.render(&split_sum)?.radiance),
                scale: None,
            },
            History::Demodulated => {
                let white = Environment::from_image("white", RgbImage::filled(64, 32, [1.0; 3]));
                let under_white = RenderRequest {
                    environment: Arc::new(white),
                    background: false,
                    ..split_sum.unlit()
                };
                let under_white = under_white.shaded(|s| {
                    s.diffuse = Diffuse::listed(NONE);
                    s.environment_scale = 1.0;
                });
                SignalTransform {
                    offset: None,
                    scale: Some(self.render(&under_white)?.radiance),
                }
            }
            History::Plain | History::Clamp | History::Reflected => SignalTransform::default(),
        })
    }
}

/// Returns a result after the tone curve, less the exact one if there is one.
fn shown_difference(curve: &ToneCurve, result: &RgbImage, exact: Option<&RgbImage>) -> Vec<DVec3> {
    let shown = |texel: [f32; 3]| DVec3::from_array(curve.apply(texel.map(f64::from)));
    let exact = |pixel| exact.map_or(DVec3::ZERO, |image| shown(image.data[pixel]));
    let texels = result.data.iter().enumerate();
    texels
        .map(|(pixel, texel)| shown(*texel) - exact(pixel))
        .collect()
}

/// The mean over the mask and channels of the variance over images; 0 for less than two.
fn flicker(images: &[Vec<DVec3>], mask: &GrayImage) -> f64 {
    let count = images.len() as f64;
    let variance = |pixel: usize| {
        let mean = images.iter().map(|image| image[pixel]).sum::<DVec3>() / count;
        images
            .iter()
            .map(|image| (image[pixel] - mean).length_squared())
            .sum::<f64>()
            / (3.0 * (count - 1.0))
    };
    let pixels: Vec<usize> = (0..mask.data.len())
        .filter(|&pixel| mask.data[pixel] == 1.0)
        .collect();
    if pixels.is_empty() || images.len() < 2 {
        return 0.0;
    }
    pixels.iter().map(|&pixel| variance(pixel)).sum::<f64>() / pixels.len() as f64
}
