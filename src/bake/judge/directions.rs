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
    /// Indices of these texels among all of the level.
    indices: Vec<usize>,
    pub(super) layout: &'static MapLayout,
    pub(super) axes: Axes,
    pub(in crate::bake) size: [u32; 2],
    grid: TexelGrid,
}

/// Where a texel lies in its face.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum TexelGrid {
    /// `(i + 0.5)/n`
    #[default]
    Centres,
    /// `i/n`
    Corners,
    /// `(i + 1)/n`
    FarCorners,
    /// Columns at `i/n`, rows at `(j + 1)/n`
    NearFarCorners,
    /// Columns at `(i + 1)/n`, rows at `j/n`
    FarNearCorners,
    /// `i/(n - 1)`
    EdgeToEdge,
}

impl TexelGrid {
    /// The grids of texels at a corner.
    pub const CORNERS: [Self; 4] = [
        Self::Corners,
        Self::FarCorners,
        Self::NearFarCorners,
        Self::FarNearCorners,
    ];

    /// Returns how far a texel lies from its centre, texels; 0 from edge to edge, where texels
    /// differ.
    pub fn shift(self) -> DVec2 {
        match self {
            Self::Centres | Self::EdgeToEdge => DVec2::ZERO,
            Self::Corners => DVec2::new(-0.5, -0.5),
            Self::FarCorners => DVec2::new(0.5, 0.5),
            Self::NearFarCorners => DVec2::new(-0.5, 0.5),
            Self::FarNearCorners => DVec2::new(0.5, -0.5),
        }
    }
}

impl Directions {
    /// Lists the texel centres of a level of `size` texels a face.
    pub fn new(layout: &'static MapLayout, axes: Axes, size: [u32; 2]) -> Self {
        let grid = TexelGrid::default();
        let centre = |index: usize| file_direction(layout, size, grid, index, DVec2::splat(0.5));
        let count = layout.face_count as usize * size[0] as usize * size[1] as usize;
        let file: Vec<DVec3> = (0..count).into_par_iter().map(centre).collect();
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

    /// Returns the same texels on another grid.
    pub fn on(&self, grid: TexelGrid) -> Self {
        let centre = |index: &usize| {
            let centre = DVec2::splat(0.5);
            let file = file_direction(self.layout, self.size, grid, *index, centre);
            self.axes.to_world(file)
        };
        Self {
            world: self.indices.iter().map(centre).collect(),
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

    /// Averages texels over the sphere.
    pub fn mean(&self, texels: &[DVec3]) -> DVec3 {
        let terms = self.weights.iter().zip(texels);
        let sum: DVec3 = terms.map(|(weight, texel)| *weight * *texel).sum();
        sum / self.weights.iter().sum::<f64>()
    }

    /// Returns face, column and row of one of these texels in the whole level.
    pub fn texel_of(&self, index: usize) -> [usize; 3] {
        self.texel(self.indices[index])
    }

    /// Averages a function over `n` x `n` points of each texel.
    pub fn means(&self, n: u32, value: impl Fn(DVec3) -> DVec3 + Sync) -> Vec<DVec3> {
        let points: Vec<DVec2> = (0..n * n)
            .map(|k| DVec2::new(f64::from(k % n) + 0.5, f64::from(k / n) + 0.5) / f64::from(n))
            .collect();
        let mean = |index: usize| {
            let index = self.indices[index];
            let values = points.iter().map(|point| {
                let file = file_direction(self.layout, self.size, self.grid, index, *point);
                value(self.axes.to_world(file))
            });
            values.sum::<DVec3>() / points.len() as f64
        };
        (0..self.world.len()).into_par_iter().map(mean).collect()
    }

    /// Lists about `count` texels, on a grid that turns and mirror images of a face keep.
    pub fn grid(&self, count: usize) -> Vec<usize> {
        let [width, height] = self.size.map(|side| side as usize);
        let rows = (count * height) as f64 / (self.layout.face_count as usize * width) as f64;
        let rows = (rows.sqrt() as usize).clamp(1, height);
        let columns = spread(width, (rows * width / height).clamp(1, width));
        let rows = spread(height, rows);
        let faces = 0..self.world.len() / (width * height);
        let row =
            |face: usize, y: usize| columns.iter().map(move |x| (face * height + y) * width + x);
        faces
            .flat_map(|face| rows.iter().flat_map(move |y| row(face, *y)))
            .collect()
    }

    /// Returns the texels at these indices.
    pub fn only(&self, chosen: &[usize]) -> Self {
        Self {
            world: chosen.iter().map(|index| self.world[*index]).collect(),
            weights: chosen.iter().map(|index| self.weights[*index]).collect(),
            indices: chosen.iter().map(|index| self.indices[*index]).collect(),
            ..*self
        }
    }
}

/// Spreads `count` indices over 0 to `side`, symmetric about the middle.
fn spread(side: usize, count: usize) -> Vec<usize> {
    let index = |i: usize| (2 * i + 1) * side / (2 * count);
    let mirrored = |i: usize| side - 1 - index(count - 1 - i);
    (0..count)
        .map(|i| if 2 * i < count { index(i) } else { mirrored(i) })
        .collect()
}

/// Returns the file's direction at a point of a texel; (0.5, 0.5) is its centre.
fn file_direction(
    layout: &MapLayout,
    [width, height]: [u32; 2],
    grid: TexelGrid,
    index: usize,
    point: DVec2,
) -> DVec3 {
    let columns = width as usize;
    let rows = height as usize;
    let face = index / (columns * rows);
    let corner = DVec2::new((index % columns) as f64, (index / columns % rows) as f64);
    let texels = corner + point;
    let size = DVec2::new(width.into(), height.into());
    let uv = match grid {
        TexelGrid::EdgeToEdge => (texels - 0.5) / (size - 1.0),
        _ => (texels + grid.shift()) / size,
    };
    (layout.direction)(face as u32, uv)
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
