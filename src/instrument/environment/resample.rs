//! Maps in other forms, resampled to the project's lat-long map: cubes, and lat-long maps whose
//! outermost texel centres lie on the edges.

use super::layout::MapLayout;
use crate::base::math::equirect;
use crate::base::names::Listed;
use crate::base::pixels::lookup::{Wrap, bilinear_at};
use crate::base::pixels::{ENVIRONMENT_TEXELS_MAX, Fault, RgbImage, TexelPosition, reserved};
use glam::{DMat3, DVec2, DVec3};
use rayon::prelude::*;

/// Texels around the horizon for each texel along an edge of a face: as many as the cube has.
const COLUMNS_PER_TEXEL: u64 = 4;
/// Most lookups across a texel, in each direction, and the fewest: below two a lookup misses
/// texels.
const LOOKUPS_MAX: u64 = 4;
const LOOKUPS_MIN: u64 = 2;
/// About as many lookups as take a few seconds.
const LOOKUPS_TOTAL: u64 = 1 << 25;

/// Six faces of a cube below each other, in the order and layout of a Vulkan cube map.
pub(super) struct Cube<'a> {
    pub strip: &'a RgbImage,
    pub texels: TexelPosition,
    /// Converts world directions to directions of the cube.
    pub file_from_world: DMat3,
}

impl Cube<'_> {
    /// Resamples to a lat-long map. Each texel is the mean of bilinear lookups that fill its solid
    /// angle evenly: a constant stays constant, and a single bright texel keeps its light within
    /// about 2 %.
    pub fn equirect(&self) -> Result<RgbImage, Fault> {
        let side = u64::from(self.strip.width);
        let widest = (2 * ENVIRONMENT_TEXELS_MAX).isqrt();
        let width = (COLUMNS_PER_TEXEL * side).min(widest) as u32;
        let height = width / 2;
        let texel_count = u64::from(width) * u64::from(height);
        let lookups = (LOOKUPS_TOTAL / texel_count)
            .isqrt()
            .clamp(LOOKUPS_MIN, LOOKUPS_MAX) as u32;
        let layout = MapLayout::listed("cube");
        let mut data = reserved(texel_count as usize)?;
        data.resize(texel_count as usize, [0.0; 3]);
        data.par_chunks_mut(width as usize)
            .enumerate()
            .for_each(|(y, row)| {
                let directions = RowDirections::new(y as u32, [width, height], lookups);
                for (x, texel) in row.iter_mut().enumerate() {
                    *texel = directions
                        .mean(x as u32, |world| self.radiance(layout, world))
                        .as_vec3()
                        .to_array();
                }
            });
        Ok(RgbImage::new(width, height, data))
    }

    fn radiance(&self, layout: &MapLayout, world: DVec3) -> DVec3 {
        let side = self.strip.width;
        let file = self.file_from_world * world;
        let texel = |face: u32, x: u32, y: u32| {
            DVec3::from_array(self.strip.get(x, face * side + y).map(f64::from))
        };
        match self.texels {
            TexelPosition::Centres => layout
                .stencil(file, [side; 2])
                .into_iter()
                .map(|([face, x, y], weight)| weight * texel(face, x, y))
                .sum(),
            // Neighbouring faces repeat the texels of their edge.
            TexelPosition::Edges => {
                let (face, uv) = (layout.face_uv)(file);
                let size = [f64::from(side); 2];
                bilinear_at(uv * f64::from(side - 1), size, Wrap::CLAMP, |x, y| {
                    texel(face, x, y)
                })
            }
        }
    }
}

/// The directions of a row of lat-long texels.
struct RowDirections {
    width: u32,
    /// Sine and cosine of the polar angle, and weight by solid angle, of the lines across the row.
    lines: Vec<Line>,
    lookups: u32,
}

struct Line {
    polar: (f64, f64),
    weight: f64,
}

impl RowDirections {
    fn new(row: u32, [width, height]: [u32; 2], lookups: u32) -> Self {
        let part = |i: u32| f64::from(row) + f64::from(i) / f64::from(lookups);
        let polar_at = |v: f64| equirect::polar_angle(v / f64::from(height));
        let row_height = polar_at(part(0)).1 - polar_at(part(lookups)).1;
        let lines = (0..lookups)
            .map(|i| Line {
                polar: polar_at(part(i) + 0.5 / f64::from(lookups)),
                weight: (polar_at(part(i)).1 - polar_at(part(i + 1)).1) / row_height,
            })
            .collect();
        Self {
            width,
            lines,
            lookups,
        }
    }

    /// Returns the mean of a function of direction over the texel of a column.
    fn mean(&self, column: u32, value: impl Fn(DVec3) -> DVec3) -> DVec3 {
        let across = f64::from(self.lookups);
        (0..self.lookups)
            .map(|i| {
                let u = (f64::from(column) + (f64::from(i) + 0.5) / across) / f64::from(self.width);
                let longitude = equirect::longitude(u);
                self.lines
                    .iter()
                    .map(|line| {
                        let direction = equirect::direction_from_angles(longitude, line.polar);
                        line.weight * value(direction)
                    })
                    .sum::<DVec3>()
            })
            .sum::<DVec3>()
            / across
    }
}

/// Fewest rows of a map that is moved from its edges: in fewer, a bright pole gains light, 37 % in
/// 8.
const EDGE_ROWS_MIN: u32 = 128;

/// Resamples a lat-long map whose outermost texel centres lie on its edges: the first and the last
/// column are one meridian, the first and the last row the poles. Small maps get a multiple of
/// their rows and columns.
pub(super) fn from_edges(image: &RgbImage) -> RgbImage {
    let finer = EDGE_ROWS_MIN.div_ceil(image.height);
    let [width, height] = [image.width, image.height].map(|side| finer * side);
    let last = DVec2::new(f64::from(image.width - 1), f64::from(image.height - 1));
    let size = [image.width, image.height].map(f64::from);
    RgbImage::from_fn(width, height, |x, y| {
        let uv = (DVec2::new(x.into(), y.into()) + 0.5) / DVec2::new(width.into(), height.into());
        let texel = |x, y| DVec3::from_array(image.get(x, y).map(f64::from));
        bilinear_at(uv * last, size, Wrap::CLAMP, texel)
            .as_vec3()
            .to_array()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::equirect::direction_from_uv;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

    /// A radiance with another slope along each axis in each channel.
    fn marker(d: DVec3) -> DVec3 {
        DVec3::new(2.0 + d.x, 1.0 + d.y / 2.0, 0.5 + d.z / 4.0)
    }

    fn strip(side: u32, texels: TexelPosition, radiance: impl Fn(DVec3) -> DVec3) -> RgbImage {
        let layout = MapLayout::listed("cube");
        RgbImage::from_fn(side, 6 * side, |x, row| {
            let place = DVec2::new(x.into(), (row % side).into());
            let uv = match texels {
                TexelPosition::Centres => (place + 0.5) / f64::from(side),
                TexelPosition::Edges => place / f64::from(side - 1),
            };
            radiance((layout.direction)(row / side, uv))
                .as_vec3()
                .to_array()
        })
    }

    struct Errors {
        largest: f64,
        rms: f64,
    }

    fn errors(map: &RgbImage, radiance: impl Fn(DVec3) -> DVec3) -> Errors {
        let size = DVec2::new(map.width.into(), map.height.into());
        let error = |(i, texel): (usize, &[f32; 3])| {
            let place = DVec2::new(
                (i % map.width as usize) as f64,
                (i / map.width as usize) as f64,
            );
            let right = radiance(direction_from_uv((place + 0.5) / size));
            (DVec3::from_array(texel.map(f64::from)) - right)
                .abs()
                .max_element()
        };
        let errors: Vec<f64> = map.data.iter().enumerate().map(error).collect();
        let squares: f64 = errors.iter().map(|error| error * error).sum();
        Errors {
            largest: errors.iter().copied().fold(0.0, f64::max),
            rms: (squares / errors.len() as f64).sqrt(),
        }
    }

    #[test]
    fn a_cube_keeps_a_constant_and_every_direction() {
        for texels in [TexelPosition::Centres, TexelPosition::Edges] {
            let quarter_turn = DMat3::from_rotation_y(FRAC_PI_2);
            let made = |side: u32, radiance: fn(DVec3) -> DVec3| {
                let cube = Cube {
                    strip: &strip(side, texels, radiance),
                    texels,
                    file_from_world: quarter_turn,
                };
                cube.equirect().unwrap()
            };
            let turned = |world: DVec3| marker(quarter_turn * world);
            let constant = made(5, |_| DVec3::new(0.25, 1.0, 700.0));
            assert_eq!(constant.data[..], vec![[0.25, 1.0, 700.0]; 20 * 10]);
            // Twice the texels have at most half the error at the corners, where three faces meet
            // and lookups are of first order, and much less in the mean.
            let coarse = errors(&made(16, marker), turned);
            let fine = errors(&made(32, marker), turned);
            assert!(coarse.largest < 0.02, "{texels:?}: {}", coarse.largest);
            assert!(coarse.rms < 5e-3, "{texels:?}: {}", coarse.rms);
            assert!(fine.largest < 0.6 * coarse.largest, "{texels:?}");
            assert!(fine.rms < 0.4 * coarse.rms, "{texels:?}");
        }
    }

    #[test]
    fn a_bright_texel_of_a_cube_keeps_its_light() {
        let side = 32;
        let layout = MapLayout::listed("cube");
        for [face, x, y] in [[0, 16, 16], [2, 4, 9], [5, 29, 3]] {
            let mut strip = RgbImage::filled(side, 6 * side, [0.0; 3]);
            strip.data[((face * side + y) * side + x) as usize] = [1e4; 3];
            let cube = Cube {
                strip: &strip,
                texels: TexelPosition::Centres,
                file_from_world: DMat3::IDENTITY,
            };
            let map = cube.equirect().unwrap();
            let row_light = |row: u32| {
                let sum: f32 = (0..map.width).map(|column| map.get(column, row)[0]).sum();
                f64::from(sum) * equirect::texel_solid_angle(row, map.width, map.height)
            };
            let light: f64 = (0..map.height).map(row_light).sum();
            let uv = (DVec2::new(x.into(), y.into()) + 0.5) / f64::from(side);
            let direction = (layout.direction)(face, uv);
            let right = 1e4 * (layout.texel_solid_angle)(direction, [side; 2], 0.0);
            assert!(
                (light / right - 1.0).abs() < 0.02,
                "face {face}: {light} for {right}"
            );
        }
    }

    /// The mean of cos θ over a cap is the mean of its two ends; over θ alone it would be 0.90.
    #[test]
    fn lookups_in_a_texel_count_by_solid_angle() {
        let top = RowDirections::new(0, [8, 4], 4).mean(0, |d| d).y;
        let right = (1.0 + FRAC_PI_4.cos()) / 2.0;
        assert!((top - right).abs() < 5e-3, "{top} for {right}");
    }

    #[test]
    fn texels_on_the_edges_are_moved_to_centres() {
        let nodes = |width: u32, height: u32| {
            RgbImage::from_fn(width, height, |x, y| {
                let uv = DVec2::new(
                    f64::from(x) / f64::from(width - 1),
                    f64::from(y) / f64::from(height - 1),
                );
                marker(direction_from_uv(uv)).as_vec3().to_array()
            })
        };
        let coarse = errors(&from_edges(&nodes(32, 16)), marker).largest;
        let fine = errors(&from_edges(&nodes(64, 32)), marker).largest;
        // A bilinear lookup errs by at most h²/8 of the second derivative along each axis, here 1.
        let bound = ((TAU / 31.0).powi(2) + (PI / 15.0).powi(2)) / 8.0;
        assert!(
            coarse < bound && fine < 0.3 * coarse,
            "{fine} after {coarse}, at most {bound}"
        );
        assert!(errors(&nodes(32, 16), marker).largest > 0.05);
        let constant = from_edges(&RgbImage::filled(7, 3, [0.1, 2.0, 3e4]));
        assert!(constant.data.iter().all(|texel| *texel == [0.1, 2.0, 3e4]));
    }

    /// A pole of 1 that falls to 0 at the next row, at the angle a, has a mean of (1 - sin a /
    /// a)/2.
    #[test]
    fn a_bright_pole_on_the_edge_keeps_its_light() {
        let nodes = RgbImage::from_fn(16, 8, |_, y| [if y == 0 { 1.0 } else { 0.0 }; 3]);
        let map = from_edges(&nodes);
        let light = |y: u32| {
            let row: f32 = (0..map.width).map(|x| map.get(x, y)[0]).sum();
            f64::from(row) * equirect::texel_solid_angle(y, map.width, map.height)
        };
        let mean = (0..map.height).map(light).sum::<f64>() / (4.0 * PI);
        let a = PI / 7.0;
        let right = 0.5 * (1.0 - a.sin() / a);
        assert!((mean / right - 1.0).abs() < 3e-3, "{mean} for {right}");
    }
}
