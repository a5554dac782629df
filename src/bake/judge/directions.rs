//! The directions of a level's texels, with their solid angles.

use crate::bake::convention::Axes;
use crate::base::pixels::RgbImage;
use crate::instrument::environment::layout::MapLayout;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Texels of a level, face by face and row by row.
pub struct Directions {
    pub world: Vec<DVec3>,
    /// Solid angle of each, sr.
    pub weights: Vec<f64>,
    /// Places of these texels among all.
    indices: Vec<usize>,
    pub(super) layout: &'static MapLayout,
    pub(super) axes: Axes,
    pub(super) size: [u32; 2],
    grid: Grid,
}

/// Places of texels: `shift` in texels from their centres, or from edge to edge of the face.
#[derive(Clone, Copy, Debug, Default)]
pub struct Grid {
    pub shift: f64,
    pub is_stretched: bool,
}

impl Directions {
    pub fn new(layout: &'static MapLayout, axes: Axes, size: [u32; 2]) -> Self {
        let grid = Grid::default();
        let of = |index: usize| place(layout, size, grid, index, DVec2::splat(0.5));
        let count = layout.face_count as usize * size[0] as usize * size[1] as usize;
        let file: Vec<DVec3> = (0..count).into_par_iter().map(of).collect();
        let weights = file
            .iter()
            .map(|direction| (layout.texel_solid_angle)(*direction, size, 0.0))
            .collect();
        Self {
            world: file
                .into_iter()
                .map(|direction| axes.to_world(direction))
                .collect(),
            weights,
            indices: (0..count).collect(),
            layout,
            axes,
            size,
            grid,
        }
    }

    /// The same texels at other places.
    pub fn on(&self, grid: Grid) -> Self {
        let of = |index: &usize| {
            self.axes.to_world(place(
                self.layout,
                self.size,
                grid,
                *index,
                DVec2::splat(0.5),
            ))
        };
        let world = self.indices.iter().map(of).collect();
        Self {
            world,
            weights: self.weights.clone(),
            indices: self.indices.clone(),
            grid,
            ..*self
        }
    }

    /// Returns face, column and row of a texel.
    pub fn texel(&self, index: usize) -> [usize; 3] {
        let [width, height] = self.size.map(|side| side as usize);
        [
            index / (width * height),
            index % width,
            index / width % height,
        ]
    }

    /// Averages a function over `n` x `n` points of each texel.
    pub fn means(&self, n: u32, value: impl Fn(DVec3) -> DVec3 + Sync) -> Vec<DVec3> {
        let points: Vec<DVec2> = (0..n * n)
            .map(|k| DVec2::new(f64::from(k % n) + 0.5, f64::from(k / n) + 0.5) / f64::from(n))
            .collect();
        let mean = |index: usize| {
            let values = points
                .iter()
                .map(|point| {
                    place(
                        self.layout,
                        self.size,
                        self.grid,
                        self.indices[index],
                        *point,
                    )
                })
                .map(|place| value(self.axes.to_world(place)));
            values.sum::<DVec3>() / points.len() as f64
        };
        (0..self.world.len()).into_par_iter().map(mean).collect()
    }

    /// Lists about `count` texels, on a grid that turns and mirror images of a face keep.
    pub fn grid(&self, count: usize) -> Vec<usize> {
        let [width, height] = self.size.map(|side| side as usize);
        let rows = (count * height) as f64 / (self.layout.face_count as usize * width) as f64;
        let rows = (rows.sqrt() as usize).clamp(1, height);
        let lines = |side: usize, count: usize| -> Vec<usize> {
            let at = |i: usize| (2 * i + 1) * side / (2 * count);
            (0..count)
                .map(|i| {
                    if 2 * i < count {
                        at(i)
                    } else {
                        side - 1 - at(count - 1 - i)
                    }
                })
                .collect()
        };
        let (rows, columns) = (
            lines(height, rows),
            lines(width, (rows * width / height).clamp(1, width)),
        );
        let faces = 0..self.world.len() / (width * height);
        let row =
            |face: usize, y: usize| columns.iter().map(move |x| (face * height + y) * width + x);
        faces
            .flat_map(|face| rows.iter().flat_map(move |y| row(face, *y)))
            .collect()
    }

    pub fn only(&self, chosen: &[usize]) -> Self {
        Self {
            world: chosen.iter().map(|index| self.world[*index]).collect(),
            weights: chosen.iter().map(|index| self.weights[*index]).collect(),
            indices: chosen.iter().map(|index| self.indices[*index]).collect(),
            ..*self
        }
    }
}

/// Returns the file's direction at a point of a texel.
fn place(
    layout: &MapLayout,
    [width, height]: [u32; 2],
    grid: Grid,
    index: usize,
    point: DVec2,
) -> DVec3 {
    let (w, h) = (width as usize, height as usize);
    let (face, x, y) = (index / (w * h), index % w, index / w % h);
    let (at, size) = (
        DVec2::new(x as f64, y as f64) + point,
        DVec2::new(width.into(), height.into()),
    );
    let at = if grid.is_stretched {
        (at - 0.5) / (size - 1.0)
    } else {
        (at + grid.shift) / size
    };
    (layout.direction)(face as u32, at)
}

/// Lists the texels of a level in the same order, times a scale.
pub fn texels(faces: &[RgbImage], scale: f64) -> Vec<DVec3> {
    let texel = |texel: &[f32; 3]| DVec3::from_array(texel.map(f64::from)) * scale;
    faces
        .iter()
        .flat_map(|face| &face.data)
        .map(texel)
        .collect()
}
