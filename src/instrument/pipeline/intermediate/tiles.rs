//! Lays out maps and tables as tiles of one image.

use super::{Encoding, IntermediateImage};
use crate::base::math::equirect::direction_from_uv;
use crate::base::pixels::{GrayImage, RgbImage};
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// The value of a tile at a position of it.
pub(super) type TileValue = Box<dyn Fn(DVec3) -> DVec3>;

/// Maps that share an image, in rows from the top left.
pub(super) struct Tiles {
    pub(super) values: Vec<TileValue>,
    /// Width over height of a tile.
    pub(super) aspect: u32,
    /// What `values` take, by the share of the width and of the height.
    pub(super) position: fn(f64, f64) -> DVec3,
    pub(super) encoding: Encoding,
}

impl Tiles {
    /// Radiance by direction, as lat-longs.
    pub(super) fn maps(values: Vec<TileValue>) -> Self {
        Self {
            values,
            aspect: 2,
            position: |u, v| direction_from_uv(DVec2::new(u, v)),
            encoding: Encoding::Radiance,
        }
    }

    /// Draws the tiles as large as an image of `size` pixels has room for.
    pub(super) fn image(self, size: [u32; 2]) -> IntermediateImage {
        let grid = Grid::largest(self.values.len() as u32, self.aspect, size);
        let mut mask = GrayImage::filled(size[0], size[1], 0.0);
        let values = RgbImage::from_fn(size[0], size[1], |x, y| {
            let Some(place) = grid.place(x, y) else {
                return [0.0; 3];
            };
            mask.data[(y * size[0] + x) as usize] = 1.0;
            let value = &self.values[place.tile as usize];
            value((self.position)(place.u, place.v))
                .as_vec3()
                .to_array()
        });
        IntermediateImage {
            values,
            mask: Arc::new(mask),
            encoding: self.encoding,
        }
    }
}

/// Tiles of one size in columns and rows, in the middle of an image.
struct Grid {
    count: u32,
    columns: u32,
    /// Pixels of a tile; 0 if an image has no room for it.
    tile: [u32; 2],
    corner: [u32; 2],
}

/// A pixel of a tile, as shares of its width and height.
struct Place {
    tile: u32,
    u: f64,
    v: f64,
}

impl Grid {
    /// Returns the grid whose tiles are largest; of equal ones the one with fewer columns.
    fn largest(count: u32, aspect: u32, [width, height]: [u32; 2]) -> Self {
        let with_columns = |columns: u32| {
            let rows = count.div_ceil(columns);
            let tile_height = (height / rows).min(width / columns / aspect);
            let tile = [tile_height * aspect, tile_height];
            Self {
                count,
                columns,
                tile,
                corner: [
                    (width - columns * tile[0]) / 2,
                    (height - rows * tile[1]) / 2,
                ],
            }
        };
        let mut best = with_columns(1);
        for columns in 2..=count {
            let grid = with_columns(columns);
            if grid.tile[1] > best.tile[1] {
                best = grid;
            }
        }
        best
    }

    fn place(&self, x: u32, y: u32) -> Option<Place> {
        let [x, y] = [
            x.checked_sub(self.corner[0])?,
            y.checked_sub(self.corner[1])?,
        ];
        let [width, height] = self.tile;
        if height == 0 {
            return None;
        }
        let [column, row] = [x / width, y / height];
        let tile = row * self.columns + column;
        let share = |pixel: u32, side: u32| (f64::from(pixel % side) + 0.5) / f64::from(side);
        (column < self.columns && tile < self.count).then(|| Place {
            tile,
            u: share(x, width),
            v: share(y, height),
        })
    }
}
