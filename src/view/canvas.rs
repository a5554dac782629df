//! The picture of both halves, stretched over a part of the window.

use super::shown::{Shot, Shown};
use crate::base::pixels::Rgb8Image;
use crate::instrument::gpu::GpuError;
use std::ops::Range;

/// Brightness of a half that is out of date, of 256.
const DIM: u32 = 96;
const BRIGHT: u32 = 256;

/// Where the picture is in the window, in its pixels.
#[derive(Clone, Copy, Debug, Default)]
pub struct Canvas {
    pub corner: [u32; 2],
    pub size: [u32; 2],
    /// Share of the width for the left half.
    pub wipe: f32,
    /// Whether the left and the right half show another state than the user asked for.
    pub is_stale: [bool; 2],
}

/// A half of the picture.
pub struct Half<'a> {
    pub shot: &'a Shot,
    /// Columns of the canvas.
    pub columns: Range<u32>,
    /// Of 256.
    pub brightness: u32,
}

impl Half<'_> {
    /// Whether its texels are interpolated. A whole picture keeps them squares.
    pub fn is_smooth(&self) -> bool {
        self.shot.scale > 1
    }
}

impl Canvas {
    /// Returns the halves that are there and have columns, the left one first.
    pub fn halves<'a>(&self, shown: &'a Shown) -> Vec<Half<'a>> {
        let width = self.size[0];
        let edge = (self.wipe * width as f32).round() as u32;
        let columns = [0..edge, edge..width];
        let shots = shown.halves.iter().zip(columns).zip(self.is_stale);
        shots
            .filter_map(|((shot, columns), is_stale)| {
                let shot = shot.as_ref().filter(|_| !columns.is_empty())?;
                Some(Half {
                    shot,
                    columns,
                    brightness: if is_stale { DIM } else { BRIGHT },
                })
            })
            .collect()
    }

    /// Returns how many texels of an image lie across and down a pixel.
    pub fn texels_a_pixel(&self, texels: [u32; 2]) -> [f32; 2] {
        [0, 1].map(|axis| texels[axis] as f32 / self.size[axis] as f32)
    }

    /// Calls `put` with each row of each half: its left end, its y and its colours. Does nothing
    /// before the first picture.
    pub fn paint(
        &self,
        shown: &Shown,
        mut put: impl FnMut(u32, u32, &[[u8; 3]]),
    ) -> Result<(), GpuError> {
        for half in self.halves(shown) {
            let picture = half.shot.picture.on_host()?;
            self.paint_half(&half, &picture, &mut put);
        }
        Ok(())
    }

    fn paint_half(
        &self,
        half: &Half,
        picture: &Rgb8Image,
        put: &mut impl FnMut(u32, u32, &[[u8; 3]]),
    ) {
        let height = self.size[1];
        let is_smooth = half.is_smooth();
        let columns = half.columns.clone();
        let [texels_across, texels_down] = self.texels_a_pixel([picture.width, picture.height]);
        let across: Vec<Texel> = columns
            .clone()
            .map(|x| Texel::new(x, texels_across, picture.width, is_smooth))
            .collect();
        let mut upper = StretchedRow::new(picture, 0, &across);
        let mut lower = StretchedRow::new(picture, 0, &across);
        let mut line = vec![[0; 3]; columns.len()];
        for y in 0..height {
            let down = Texel::new(y, texels_down, picture.height, is_smooth);
            upper.change_to(picture, down.first, &across);
            lower.change_to(picture, down.second, &across);
            let upper_weight = (256 - down.weight) * half.brightness;
            let lower_weight = down.weight * half.brightness;
            for ((color, above), below) in line.iter_mut().zip(&upper.colors).zip(&lower.colors) {
                for channel in 0..3 {
                    let sum = above[channel] * upper_weight + below[channel] * lower_weight;
                    color[channel] = (sum >> 24) as u8;
                }
            }
            put(columns.start, y, &line);
        }
    }
}

/// A row of a picture at the width of a half; its colours are times 256.
struct StretchedRow {
    y: usize,
    colors: Vec<[u32; 3]>,
}

impl StretchedRow {
    fn new(picture: &Rgb8Image, y: usize, across: &[Texel]) -> Self {
        let width = picture.width as usize;
        let row = &picture.data[y * width..][..width];
        let color = |texel: &Texel| {
            texel.mean(
                row[texel.first].map(u32::from),
                row[texel.second].map(u32::from),
            )
        };
        Self {
            y,
            colors: across.iter().map(color).collect(),
        }
    }

    fn change_to(&mut self, picture: &Rgb8Image, y: usize, across: &[Texel]) {
        if self.y != y {
            *self = Self::new(picture, y, across);
        }
    }
}

/// The two texels that a pixel lies between, and the weight of the second, of 256.
/// `shaders/window` computes the same operations, each rounded once, so both find the same.
struct Texel {
    first: usize,
    second: usize,
    weight: u32,
}

impl Texel {
    /// A pixel whose side is `texels_a_pixel` of `texel_count` texels.
    fn new(pixel: u32, texels_a_pixel: f32, texel_count: u32, is_smooth: bool) -> Self {
        let mut position = (pixel as f32 + 0.5) * texels_a_pixel;
        if is_smooth {
            position = (position - 0.5).max(0.0);
        }
        let first = position as usize;
        let last = texel_count as usize - 1;
        Self {
            first: first.min(last),
            second: (first + 1).min(last),
            weight: if is_smooth {
                ((position - first as f32) * 256.0) as u32
            } else {
                0
            },
        }
    }

    /// Returns 256 times the weighted mean.
    #[inline]
    fn mean(&self, [r, g, b]: [u32; 3], [s, h, c]: [u32; 3]) -> [u32; 3] {
        let near = 256 - self.weight;
        [
            r * near + s * self.weight,
            g * near + h * self.weight,
            b * near + c * self.weight,
        ]
    }
}

/// Returns the picture as it is saved: at the resolution of the finer half; `None` before the
/// first one.
pub fn composed(shown: &Shown, wipe: f32) -> Result<Option<Rgb8Image>, GpuError> {
    let Some([width, height]) = shown.size() else {
        return Ok(None);
    };
    let mut image = Rgb8Image::filled(width, height, [0; 3]);
    let canvas = Canvas {
        size: [width, height],
        wipe,
        ..Canvas::default()
    };
    canvas.paint(shown, |x, y, row| {
        image.data[(y * width + x) as usize..][..row.len()].copy_from_slice(row)
    })?;
    Ok(Some(image))
}
