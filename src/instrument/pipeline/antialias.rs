//! Antialiased edges.
//!
//! Shading stays at one point per pixel, so that "16 samples a pixel" means 16. A g-buffer with
//! [`POINTS_PER_SIDE`]² points per pixel finds the pixels where surfaces meet, or a surface and the
//! background. Each point takes the radiance of the most similar of the nine pixels around it; the
//! pixel is the mean. Scores exclude these pixels.

use super::Frame;
use crate::base::pixels::GrayImage;
use crate::instrument::gbuffer::Surfaces;
use crate::instrument::scene::{Camera, Projection};
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// Points along a pixel's side: 17 steps from uncovered to covered.
const POINTS_PER_SIDE: u32 = 4;
/// Rows of pixels whose points are in memory at once.
const ROWS: u32 = 16;
const POINTS: usize = (POINTS_PER_SIDE * POINTS_PER_SIDE) as usize;
/// Points that differ more belong to different surfaces: normals 37 degrees apart, or a step of a
/// pixel's width.
pub(super) const UNLIKE: f32 = 0.2;

/// A point of a surface.
#[derive(Clone, Copy)]
pub(super) struct SurfacePoint {
    pub(super) position: Vec3,
    pub(super) normal: Vec3,
}

/// Returns the size of a view's points.
pub(super) fn points_size(size: [u32; 2]) -> [u32; 2] {
    size.map(|side| side * POINTS_PER_SIDE)
}

/// A pixel that several surfaces share.
struct Edge {
    /// Index of the pixel.
    pixel: usize,
    /// Indices of the pixels that its points take their radiance from.
    sources: [usize; POINTS],
}

impl Edge {
    /// Compares the centre of a pixel with its points, which `point` returns by index; `None` if one
    /// surface fills the pixel.
    fn of(
        pixels: &Surfaces,
        [x, y]: [u32; 2],
        difference: &impl Fn(Option<SurfacePoint>, Option<SurfacePoint>) -> f32,
        point: impl Fn(u32) -> Option<SurfacePoint>,
    ) -> Option<Self> {
        let [width, height] = [pixels.position_mask.width, pixels.position_mask.height];
        let index = (y * width + x) as usize;
        let centre = surface_point(pixels, x, y);
        let mut is_edge = false;
        let sources = std::array::from_fn(|i| {
            let point = point(i as u32);
            let unlike = difference(point, centre);
            if unlike < UNLIKE {
                return index;
            }
            is_edge = true;
            let rows = y.saturating_sub(1)..=(y + 1).min(height - 1);
            let around = rows
                .flat_map(|y| (x.saturating_sub(1)..=(x + 1).min(width - 1)).map(move |x| (x, y)));
            let nearest = around
                .map(|(x, y)| {
                    (
                        difference(point, surface_point(pixels, x, y)),
                        (y * width + x) as usize,
                    )
                })
                .min_by(|a, b| a.0.total_cmp(&b.0));
            nearest
                .filter(|(least, _)| *least < unlike)
                .map_or(index, |(_, source)| source)
        });
        is_edge.then_some(Self {
            pixel: index,
            sources,
        })
    }
}

/// The pixels that several surfaces share.
pub(super) struct Edges(Vec<Edge>);

impl Edges {
    /// Compares the centre of each pixel with its points; `read` returns some rows of points.
    pub(super) fn find<E>(
        pixels: &Surfaces,
        camera: &Camera,
        mut read: impl FnMut(Range<u32>) -> Result<Surfaces, E>,
    ) -> Result<Self, E> {
        let [width, height] = [pixels.position_mask.width, pixels.position_mask.height];
        let difference = difference(camera, [width, height]);
        let mut edges = Vec::new();
        for first in (0..height).step_by(ROWS as usize) {
            let rows = first..(first + ROWS).min(height);
            let points = read(rows.start * POINTS_PER_SIDE..rows.end * POINTS_PER_SIDE)?;
            let edge = |index: u32| {
                let [x, row] = [index % width, index / width];
                let point = |i: u32| {
                    let column = x * POINTS_PER_SIDE + i % POINTS_PER_SIDE;
                    surface_point(&points, column, row * POINTS_PER_SIDE + i / POINTS_PER_SIDE)
                };
                Edge::of(pixels, [x, first + row], &difference, point)
            };
            let pixels_in_rows = (rows.end - rows.start) * width;
            edges.par_extend((0..pixels_in_rows).into_par_iter().filter_map(edge));
        }
        Ok(Self(edges))
    }

    /// Resolves the edges of a frame. The mask keeps the pixels that one surface fills.
    pub(super) fn resolve(&self, frame: Frame) -> Frame {
        let mut radiance = frame.radiance.clone();
        let mut mask = GrayImage::clone(&frame.mask);
        for Edge { pixel, sources } in &self.0 {
            let sum = |channel: usize| {
                sources
                    .iter()
                    .map(|&source| frame.radiance.data[source][channel])
                    .sum::<f32>()
            };
            radiance.data[*pixel] = std::array::from_fn(|channel| sum(channel) / POINTS as f32);
            mask.data[*pixel] = 0.0;
        }
        Frame {
            radiance,
            mask: Arc::new(mask),
            ..frame
        }
    }

    pub(super) fn bytes(&self) -> u64 {
        size_of_val(&self.0[..]) as u64
    }
}

/// Returns the difference of two points in an image of a camera: 0 on one plane, [`UNLIKE`] and
/// more on different surfaces.
pub(super) fn difference(
    camera: &Camera,
    [width, height]: [u32; 2],
) -> impl Fn(Option<SurfacePoint>, Option<SurfacePoint>) -> f32 + Sync + use<> {
    let [_, half_height] = camera.extent(f64::from(width) / f64::from(height));
    let step = (2.0 * half_height / f64::from(height)) as f32;
    let eye = camera.eye.as_vec3();
    let forward = camera.forward.as_vec3();
    let is_perspective = matches!(camera.projection, Projection::Perspective { .. });
    move |a, b| match (a, b) {
        (None, None) => 0.0,
        (Some(a), Some(b)) => {
            let width = if is_perspective {
                step * (a.position - eye).dot(forward)
            } else {
                step
            };
            1.0 - a.normal.dot(b.normal)
                + UNLIKE * (a.position - b.position).dot(b.normal).abs() / width
        }
        _ => f32::INFINITY,
    }
}

/// Returns the point at a texel; `None` if nothing is hit.
pub(super) fn surface_point(surfaces: &Surfaces, x: u32, y: u32) -> Option<SurfacePoint> {
    let [px, py, pz, mask] = surfaces.position_mask.get(x, y);
    let [nx, ny, nz, _] = surfaces.normal_alpha.get(x, y);
    (mask == 1.0).then(|| SurfacePoint {
        position: Vec3::new(px, py, pz),
        normal: Vec3::new(nx, ny, nz),
    })
}
