//! The history of a sequence of frames: sums of signals and weights, looked up where the frame
//! before saw the same surface.
//!
//! The recurrence is in [`super::frames`].

use super::antialias::{SurfacePoint, UNLIKE, difference, surface_point};
use crate::instrument::gbuffer::Surfaces;
use crate::instrument::scene::Camera;
use crate::instrument::shade::frames::{Frames, History};
use glam::{DMat3, DVec2, DVec3};
use rayon::prelude::*;
use std::sync::Arc;

/// Most steps to a reflection, and the miss that ends them: below the width of any lobe.
const REFLECTION_STEPS: usize = 16;
const REFLECTION_MISS: f64 = 1e-3;

/// What a frame's camera sees.
#[derive(Debug)]
pub struct View {
    pub camera: Camera,
    pub environment_from_world: DMat3,
    pub surfaces: Arc<Surfaces>,
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

impl View {
    fn size(&self) -> [u32; 2] {
        [
            self.surfaces.position_mask.width,
            self.surfaces.position_mask.height,
        ]
    }

    /// Returns the surface at a pixel; `None` off the image or if nothing is hit.
    fn surface(&self, [x, y]: [i64; 2]) -> Option<SurfacePoint> {
        let [width, height] = self.size();
        let is_inside = (0..i64::from(width)).contains(&x) && (0..i64::from(height)).contains(&y);
        if is_inside {
            surface_point(&self.surfaces, x as u32, y as u32)
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
