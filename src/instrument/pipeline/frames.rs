//! Sequences of frames, each added on the host to a history of linear radiance.
//!
//! The history of a pixel is the weighted sum S of its signals and the sum W of their weights. A
//! frame of signal x gives
//!
//! ```text
//! S = q S' + x      W = q W' + 1      result S / W
//! ```
//!
//! S' and W' belong to the frame before, bilinear at the place where it saw the same surface;
//! pixels of another surface count 0 there, so W falls where a surface appears. The geometry is
//! known, so reprojection is exact up to the bilinear lookup. The signal is `(L - offset) / scale`;
//! offset and scale are 0 and 1 unless [`History`] says otherwise.

use super::antialias::{UNLIKE, difference, point};
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
use glam::{DMat3, DVec2, DVec3, Vec3};
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

#[derive(Debug)]
pub struct View {
    pub camera: Camera,
    pub environment_from_world: DMat3,
    pub gbuffer: Arc<Gbuffer<f32>>,
}

/// The sums of each pixel up to a frame: of weighted signals, and of weights.
#[derive(Debug)]
pub struct Sums {
    view: Arc<View>,
    pixels: Vec<(DVec3, f64)>,
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
        let own = self.shaded(|s| {
            s.frame = Some(index);
            s.placement.rotation_deg += if motion == Motion::Light { turn } else { 0.0 };
        });
        let orbit = Orbit {
            yaw_deg: if motion == Motion::Orbit { turn } else { 0.0 },
            ..Orbit::default()
        };
        Self {
            camera: own.camera.orbited(orbit, &own.scene),
            ..own
        }
    }

    /// Returns the request of a frame without noise, with the same lookups.
    fn converged(&self) -> Self {
        self.shaded(|s| {
            s.lod_bias += 0.5 * (CONVERGED_SAMPLES as f32 / s.samples as f32).log2();
            (s.frame, s.frames.count, s.samples) = (None, 1, CONVERGED_SAMPLES);
            (s.sequence, s.point_set, s.pixel_points) = (&SEQUENCES[0], 0, PixelPoints::Shared);
        })
    }

    /// Returns the shift of each pixel's points, if the frame has one.
    pub(super) fn point_shifts(&self) -> Option<Vec<[u32; 2]>> {
        let (shading, [width, height]) = (&self.shading, self.size);
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

    /// Position and normal at a pixel; `None` off the image or if nothing is hit.
    fn surface(&self, [x, y]: [i64; 2]) -> Option<(Vec3, Vec3)> {
        let [width, height] = self.size();
        let is_inside = (0..i64::from(width)).contains(&x) && (0..i64::from(height)).contains(&y);
        if is_inside {
            point(&self.gbuffer, x as u32, y as u32)
        } else {
            None
        }
    }

    /// The pixels around a place, each with its share of a bilinear lookup.
    fn taps(place: DVec2) -> [([i64; 2], f64); 4] {
        // A place that is not a number is off the image.
        let place = if place.is_finite() {
            place
        } else {
            DVec2::splat(-2.0)
        };
        let (low, t) = (place.floor(), place - place.floor());
        [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[right, down]| {
            let share = |part: f64, step: i64| if step == 1 { part } else { 1.0 - part };
            (
                [low.x as i64 + right, low.y as i64 + down],
                share(t.x, right) * share(t.y, down),
            )
        })
    }
}

impl View {
    /// The direction in the environment that a place reflects to the viewer; `None` off the
    /// surfaces.
    fn reflected(&self, place: DVec2) -> Option<DVec3> {
        let (mut position, mut normal) = (DVec3::ZERO, DVec3::ZERO);
        for (pixel, share) in Self::taps(place)
            .into_iter()
            .filter(|(_, share)| *share > 0.0)
        {
            let (own, own_normal) = self.surface(pixel)?;
            position += share * own.as_dvec3();
            normal += share * own_normal.as_dvec3();
        }
        let (n, v) = (normal.normalize(), self.camera.v_at(position));
        Some(self.environment_from_world * (2.0 * n.dot(v) * n - v))
    }

    /// The place that reflects a direction, by Gauss-Newton from another place; `None` if that
    /// finds none.
    fn place_of_reflection(&self, target: DVec3, mut place: DVec2) -> Option<DVec2> {
        for _ in 0..REFLECTION_STEPS {
            let own = self.reflected(place)?;
            let miss = target - own;
            if miss.length() < REFLECTION_MISS {
                return Some(place);
            }
            let [right, down] =
                [DVec2::X, DVec2::Y].map(|step| Some(self.reflected(place + step)? - own));
            let (right, down) = (right?, down?);
            let (a, b, c) = (right.dot(right), right.dot(down), down.dot(down));
            let (u, v) = (right.dot(miss), down.dot(miss));
            place += DVec2::new(c * u - b * v, a * v - b * u) / (a * c - b * b);
        }
        None
    }
}

impl Sums {
    pub fn added(
        before: Option<&Self>,
        frames: &Frames,
        view: &Arc<View>,
        signal: &[DVec3],
    ) -> Self {
        let kept = frames.kept();
        let pixel = |index: usize| {
            let (mut sum, weight) = before.map_or((DVec3::ZERO, 0.0), |before| {
                before.seen_from(view, index, frames.history)
            });
            if frames.history == History::Clamp && weight > 0.0 {
                let [least, most] = range_around(view, signal, index);
                sum = weight * (sum / weight).clamp(least, most);
            }
            (kept * sum + signal[index], kept * weight + 1.0)
        };
        Self {
            view: view.clone(),
            pixels: (0..signal.len()).into_par_iter().map(pixel).collect(),
        }
    }

    pub fn means(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.pixels.iter().map(|(sum, weight)| sum / weight)
    }

    /// The sums at the place where this frame saw the surface of a pixel of `view`, or the light
    /// that it reflects.
    fn seen_from(&self, view: &View, index: usize, history: History) -> (DVec3, f64) {
        let [width, height] = view.size();
        let pixel = [index as u32 % width, index as u32 / width].map(i64::from);
        let Some(surface) = view.surface(pixel) else {
            return (DVec3::ZERO, 0.0);
        };
        let own = self
            .view
            .camera
            .pixel_of(surface.0.as_dvec3(), [width, height]);
        let reflected = || {
            let place = DVec2::new(pixel[0] as f64, pixel[1] as f64);
            self.view.place_of_reflection(view.reflected(place)?, own)
        };
        let reflected = Some(history)
            .filter(|history| *history == History::Reflected)
            .and_then(|_| reflected());
        if reflected.is_none() && view.camera == self.view.camera {
            return self.pixels[index];
        }
        let place = reflected.unwrap_or(own);
        let difference = difference(&self.view.camera, [width, height]);
        let is_same = |pixel: &[i64; 2]| match (reflected, self.view.surface(*pixel)) {
            (Some(_), other) => other.is_some(),
            (None, other) => difference(other, Some(surface)) < UNLIKE,
        };
        let taps = View::taps(place)
            .into_iter()
            .filter(|(pixel, share)| *share > 0.0 && is_same(pixel));
        taps.fold((DVec3::ZERO, 0.0), |(sum, weight), ([x, y], share)| {
            let (own, own_weight) = self.pixels[(y * i64::from(width) + x) as usize];
            (sum + share * own, weight + share * own_weight)
        })
    }
}

/// Least and largest signal of the surfaces in the 3x3 pixels around one.
fn range_around(view: &View, signal: &[DVec3], index: usize) -> [DVec3; 2] {
    let width = i64::from(view.size()[0]);
    let (x, y) = (index as i64 % width, index as i64 / width);
    let around = (-1..=1).flat_map(|down| (-1..=1).map(move |right| [x + right, y + down]));
    let signals = around
        .filter(|pixel| view.surface(*pixel).is_some())
        .map(|[x, y]| signal[(y * width + x) as usize]);
    signals.fold([signal[index]; 2], |[least, most], own| {
        [least.min(own), most.max(own)]
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
        [offset, scale]: &[Option<RgbImage>; 2],
        frame: &RgbImage,
    ) -> RgbImage {
        let wide =
            |image: &RgbImage, index: usize| DVec3::from_array(image.data[index].map(f64::from));
        let offset = |index| {
            offset
                .as_ref()
                .map_or(DVec3::ZERO, |image| wide(image, index))
        };
        let scale = |index| {
            scale.as_ref().map_or(DVec3::ONE, |image| {
                wide(image, index).max(DVec3::splat(SCALE_MIN))
            })
        };
        let signal = |index| (wide(frame, index) - offset(index)) / scale(index);
        let signal: Vec<DVec3> = (0..frame.data.len()).map(signal).collect();
        let sums = Sums::added(self.sums.as_ref(), frames, view, &signal);
        let radiance = |(index, mean): (usize, DVec3)| {
            let result = (offset(index) + scale(index) * mean).max(DVec3::ZERO);
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

/// A view and the parts of its signal: offset and scale, if they are not 0 and 1.
type Seen = (Arc<View>, [Option<RgbImage>; 2]);

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
        let (mut filter, mut without_noise) = (Filter::default(), Filter::default());
        let (mut seen, mut timings, mut last) = (None, FrameTimings::default(), None);
        // After the tone curve: the results of the last frames less, under motion, the results
        // without noise.
        let mut differences: Vec<Vec<DVec3>> = Vec::new();
        for index in 0..frames.count {
            let pose = request.of_frame(index);
            let frame = self.render(&pose)?;
            if is_moving || seen.is_none() {
                seen = Some(self.seen(&pose, seen.as_ref())?);
            }
            let (view, parts) = seen.as_ref().expect("it was made");
            let radiance = filter.add(&frames, view, parts, &frame.radiance);
            // A still view without noise is the same in every frame.
            let is_last = index + 1 == frames.count;
            let exact = if is_moving || is_last {
                Some(self.render(&pose.converged())?.radiance)
            } else {
                None
            };
            let steady = exact.map(|exact| match is_moving {
                true => without_noise.add(&frames, view, parts, &exact),
                false => exact,
            });
            timings = timings.and(frame.timings.clone());
            if index + FLICKER_FRAMES >= frames.count {
                let moving = steady.as_ref().filter(|_| is_moving);
                let own = |pixel| moving.map_or(DVec3::ZERO, |image| shown(image.data[pixel]));
                let texels = radiance.data.iter().enumerate();
                differences.push(
                    texels
                        .map(|(pixel, texel)| shown(*texel) - own(pixel))
                        .collect(),
                );
            }
            last = Some((Frame { radiance, ..frame }, steady));
        }
        let (frame, steady) = last.expect("a sequence has at least two frames");
        let flicker = flicker(&differences, &frame.mask);
        let steadiness = steady.map(|without_noise| Steadiness {
            without_noise,
            flicker,
        });
        Ok(Frame {
            steadiness,
            timings,
            ..frame
        })
    }

    /// Returns what a frame sees; `before` lends its g-buffer if the camera stands still.
    fn seen(&mut self, pose: &RenderRequest, before: Option<&Seen>) -> Result<Seen, PipelineError> {
        let known = before
            .filter(|(view, _)| view.camera == pose.camera)
            .map(|(view, _)| view.gbuffer.clone());
        let gbuffer = match known {
            Some(gbuffer) => gbuffer,
            None => {
                let (_, target) = self.resources.view(&self.gpu, pose)?;
                Arc::new(target.gbuffer.read(&self.gpu)?)
            }
        };
        let environment_from_world = pose.shading.placement.environment_from_world();
        let view = Arc::new(View {
            camera: pose.camera,
            environment_from_world,
            gbuffer,
        });
        let split = pose.shaded(|s| {
            (s.method, s.frame, s.frames) = (Method::listed("split-sum"), None, Frames::default());
        });
        let parts = match pose.shading.frames.history {
            History::ControlVariate => [Some(self.render(&split)?.radiance), None],
            History::Demodulated => {
                let white = Environment::from_image("white", RgbImage::filled(64, 32, [1.0; 3]));
                let white = RenderRequest {
                    environment: Arc::new(white),
                    background: false,
                    ..split
                };
                let white = white
                    .shaded(|s| (s.diffuse, s.environment_scale) = (Diffuse::listed(NONE), 1.0));
                [None, Some(self.render(&white)?.radiance)]
            }
            _ => [None, None],
        };
        Ok((view, parts))
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
