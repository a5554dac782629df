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
//!
//! Long because a sequence shares the states of its methods, which these functions hand on.

use super::antialias::{SurfacePoint, UNLIKE, difference, surface_point};
use super::request::{Frame, FrameTimings, Steadiness};
use super::{Pipeline, PipelineError, RenderRequest};
use crate::base::math::sequence::{FramePoints, PixelPoints, SEQUENCES, frame_shift};
use crate::base::names::Listed;
use crate::base::pixels::{GrayImage, Pixels, RgbImage};
use crate::instrument::environment::Environment;
use crate::instrument::gbuffer::Gbuffer;
use crate::instrument::metrics::tone_mapped_curve;
use crate::instrument::scene::{Camera, Orbit};
use crate::instrument::shade::frames::{Frames, History, Motion};
use crate::instrument::shade::{Diffuse, Method, NONE};
use glam::{DMat3, DVec2, DVec3};
use rayon::prelude::*;
use std::sync::Arc;

/// Samples of the frames that stand for frames without noise; their points are the same in all
/// pixels and frames.
pub const CONVERGED_SAMPLES: u32 = 64;
/// Last frames that the flicker is about.
const FLICKER_FRAMES: u32 = 8;
/// Most steps to a reflection, and the miss that ends them: below the width of any lobe.
const REFLECTION_STEPS: usize = 16;
const REFLECTION_MISS: f64 = 1e-3;
/// Smallest divisor of a demodulated signal.
const SCALE_MIN: f64 = 1e-3;

/// What a frame's camera sees.
#[derive(Debug)]
pub struct View {
    pub camera: Camera,
    pub environment_from_world: DMat3,
    pub gbuffer: Arc<Gbuffer<f32>>,
}

/// The sums of each pixel up to a frame.
#[derive(Debug)]
pub struct Sums {
    view: Arc<View>,
    pixels: Vec<PixelSum>,
}

/// Sums of weighted signals and of weights, S and W.
#[derive(Clone, Copy, Debug, Default)]
struct PixelSum {
    signal: DVec3,
    weight: f64,
}

/// A pixel and its share of a bilinear lookup.
struct Tap {
    pixel: [i64; 2],
    share: f64,
}

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

impl View {
    fn size(&self) -> [u32; 2] {
        [
            self.gbuffer.position_mask.width,
            self.gbuffer.position_mask.height,
        ]
    }

    /// Returns the surface at a pixel; `None` off the image or if nothing is hit.
    fn surface(&self, [x, y]: [i64; 2]) -> Option<SurfacePoint> {
        let [width, height] = self.size();
        let is_inside = (0..i64::from(width)).contains(&x) && (0..i64::from(height)).contains(&y);
        if is_inside {
            surface_point(&self.gbuffer, x as u32, y as u32)
        } else {
            None
        }
    }

    /// Returns the pixels of a bilinear lookup at a position in the image.
    fn taps(position: DVec2) -> impl Iterator<Item = Tap> {
        // A position that is not a number is off the image.
        let position = if position.is_finite() {
            position
        } else {
            DVec2::splat(-2.0)
        };
        let low = position.floor();
        let t = position - low;
        let share = |part: f64, step: i64| if step == 1 { part } else { 1.0 - part };
        let taps = [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[right, down]| Tap {
            pixel: [low.x as i64 + right, low.y as i64 + down],
            share: share(t.x, right) * share(t.y, down),
        });
        taps.into_iter().filter(|tap| tap.share > 0.0)
    }

    /// Returns the direction in the environment that a position reflects to the viewer; `None` off
    /// the surfaces.
    fn reflected(&self, position: DVec2) -> Option<DVec3> {
        let mut mean_position = DVec3::ZERO;
        let mut mean_normal = DVec3::ZERO;
        for Tap { pixel, share } in Self::taps(position) {
            let surface = self.surface(pixel)?;
            mean_position += share * surface.position.as_dvec3();
            mean_normal += share * surface.normal.as_dvec3();
        }
        let n = mean_normal.normalize();
        let v = self.camera.v_at(mean_position);
        Some(self.environment_from_world * (2.0 * n.dot(v) * n - v))
    }

    /// Finds the position that reflects a direction, by Gauss-Newton from a first guess; `None` if
    /// that does not converge.
    fn position_of_reflection(&self, direction: DVec3, guess: DVec2) -> Option<DVec2> {
        let mut position = guess;
        for _ in 0..REFLECTION_STEPS {
            let reflected = self.reflected(position)?;
            let miss = direction - reflected;
            if miss.length() < REFLECTION_MISS {
                return Some(position);
            }
            let right = self.reflected(position + DVec2::X)? - reflected;
            let down = self.reflected(position + DVec2::Y)? - reflected;
            // The normal equations, by Cramer's rule.
            let right_right = right.dot(right);
            let right_down = right.dot(down);
            let down_down = down.dot(down);
            let right_miss = right.dot(miss);
            let down_miss = down.dot(miss);
            position += DVec2::new(
                down_down * right_miss - right_down * down_miss,
                right_right * down_miss - right_down * right_miss,
            ) / (right_right * down_down - right_down * right_down);
        }
        None
    }
}

impl Sums {
    /// Adds the signal of a frame to the sums up to the frame before.
    pub fn added(
        before: Option<&Self>,
        frames: &Frames,
        view: &Arc<View>,
        signal: &[DVec3],
    ) -> Self {
        let kept = frames.kept();
        let pixel = |index: usize| {
            let mut history = before.map_or(PixelSum::default(), |before| {
                before.reprojected(view, index, frames.history)
            });
            if frames.history == History::Clamp && history.weight > 0.0 {
                let [least, most] = range_around(view, signal, index);
                history.signal =
                    history.weight * (history.signal / history.weight).clamp(least, most);
            }
            PixelSum {
                signal: kept * history.signal + signal[index],
                weight: kept * history.weight + 1.0,
            }
        };
        Self {
            view: view.clone(),
            pixels: (0..signal.len()).into_par_iter().map(pixel).collect(),
        }
    }

    /// Returns the result S / W of each pixel.
    pub fn means(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.pixels.iter().map(|sum| sum.signal / sum.weight)
    }

    /// Looks up the sums where this frame saw the surface of a pixel of `view`, or the light that
    /// the surface reflects.
    fn reprojected(&self, view: &View, index: usize, history: History) -> PixelSum {
        let [width, height] = view.size();
        let pixel = [index as u32 % width, index as u32 / width].map(i64::from);
        let Some(surface) = view.surface(pixel) else {
            return PixelSum::default();
        };
        let position = self
            .view
            .camera
            .pixel_of(surface.position.as_dvec3(), [width, height]);
        let reflection = if history == History::Reflected {
            view.reflected(DVec2::new(pixel[0] as f64, pixel[1] as f64))
                .and_then(|direction| self.view.position_of_reflection(direction, position))
        } else {
            None
        };
        if reflection.is_none() && view.camera == self.view.camera {
            return self.pixels[index];
        }
        let difference = difference(&self.view.camera, [width, height]);
        let is_same = |tap: &Tap| {
            let other = self.view.surface(tap.pixel);
            if reflection.is_some() {
                other.is_some()
            } else {
                difference(other, Some(surface)) < UNLIKE
            }
        };
        let mut sum = PixelSum::default();
        for Tap {
            pixel: [x, y],
            share,
        } in View::taps(reflection.unwrap_or(position)).filter(is_same)
        {
            let before = self.pixels[(y * i64::from(width) + x) as usize];
            sum.signal += share * before.signal;
            sum.weight += share * before.weight;
        }
        sum
    }
}

/// Least and largest signal of the surfaces in the 3x3 pixels around one.
fn range_around(view: &View, signal: &[DVec3], index: usize) -> [DVec3; 2] {
    let width = i64::from(view.size()[0]);
    let x = index as i64 % width;
    let y = index as i64 / width;
    let around = (-1..=1).flat_map(|down| (-1..=1).map(move |right| [x + right, y + down]));
    let signals = around
        .filter(|pixel| view.surface(*pixel).is_some())
        .map(|[x, y]| signal[(y * width + x) as usize]);
    signals.fold([signal[index]; 2], |[least, most], value| {
        [least.min(value), most.max(value)]
    })
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
        let shown = |texel: [f32; 3]| DVec3::from_array(curve.apply(texel.map(f64::from)));
        let mut filter = Filter::default();
        let mut filter_without_noise = Filter::default();
        let mut pose: Option<Pose> = None;
        let mut timings = FrameTimings::default();
        let mut last = None;
        // After the tone curve: the results of the last frames less, under motion, the results
        // without noise.
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
                let moving = without_noise.as_ref().filter(|_| is_moving);
                let exact = |pixel| moving.map_or(DVec3::ZERO, |image| shown(image.data[pixel]));
                let texels = radiance.data.iter().enumerate();
                differences.push(
                    texels
                        .map(|(pixel, texel)| shown(*texel) - exact(pixel))
                        .collect(),
                );
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

    /// Returns the pose of a frame; the g-buffer is the one before if the camera stands
    /// still.
    fn pose(
        &mut self,
        request: &RenderRequest,
        before: Option<&Pose>,
    ) -> Result<Pose, PipelineError> {
        let known = before
            .filter(|pose| pose.view.camera == request.camera)
            .map(|pose| pose.view.gbuffer.clone());
        let gbuffer = match known {
            Some(gbuffer) => gbuffer,
            None => {
                let (_, target) = self.resources.view(&self.gpu, request)?;
                Arc::new(target.gbuffer.read(&self.gpu)?)
            }
        };
        let view = View {
            camera: request.camera,
            environment_from_world: request.shading.placement.environment_from_world(),
            gbuffer,
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
                    ..split_sum
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
