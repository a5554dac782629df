//! Pictures of what lies between a scene and its image: attachments of the g-buffer, and the tables
//! that the terms of the image read.

use super::light_tables::{read_level, read_texels};
use super::resources::Prepared;
use super::{Pipeline, PipelineError, RenderRequest};
use crate::base::color::srgb_encode;
use crate::base::math::equirect::direction_from_uv;
use crate::base::math::spherical_harmonics;
use crate::base::names::{Listed, listed};
use crate::base::pixels::{GrayImage, Pixels, Rgb8Image, RgbImage};
use crate::instrument::environment::layout::FilteredMap;
use crate::instrument::gbuffer::Gbuffer;
use crate::instrument::gpu::Image;
use crate::instrument::tonemap::ToneCurve;
use glam::{DVec2, DVec3, Vec3};
use std::f64::consts::PI;
use std::fmt;
use std::sync::Arc;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Intermediate {
    /// World position.
    Position,
    /// Unit normal in world axes.
    Normal,
    /// Linear albedo, before `1 - metallic`.
    Albedo,
    F0,
    Alpha,
    Metallic,
    /// Ambient occlusion; 1 on surfaces without a map.
    Occlusion,
    /// Irradiance over π that the diffuse method reads, as a lat-long map.
    Irradiance,
    /// Levels of the prefiltered map, as lat-long maps.
    Prefiltered,
    /// A and B of the DFG table: n·v from left to right, roughness from top to bottom.
    Dfg,
}

listed!(Intermediate, "intermediate", {
    "position": Position,
    "normal": Normal,
    "albedo": Albedo,
    "f0": F0,
    "alpha": Alpha,
    "metallic": Metallic,
    "occlusion": Occlusion,
    "irradiance": Irradiance,
    "prefiltered": Prefiltered,
    "dfg": Dfg,
});

/// What a picture shows of a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Selection {
    pub intermediate: Intermediate,
    /// The level of the prefiltered map; `None` shows all levels, the finest first.
    pub level: Option<u32>,
}

impl From<Intermediate> for Selection {
    fn from(intermediate: Intermediate) -> Self {
        Self {
            intermediate,
            level: None,
        }
    }
}

impl fmt::Display for Selection {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.intermediate.name())?;
        self.level.map_or(Ok(()), |level| write!(f, "-{level}"))
    }
}

impl Selection {
    /// Reads the name of an intermediate, or of one prefiltered level: `prefiltered-3`.
    pub fn parse(text: &str) -> Result<Self, String> {
        let level = text
            .rsplit_once('-')
            .and_then(|(name, level)| Some((name, level.parse().ok()?)))
            .filter(|(name, _)| *name == Intermediate::Prefiltered.name());
        match level {
            Some((_, level)) => Ok(Self {
                intermediate: Intermediate::Prefiltered,
                level: Some(level),
            }),
            None => Ok(Intermediate::parse(text)?.to_owned().into()),
        }
    }

    /// Returns why the image of `request` has no such intermediate, if it has none.
    pub fn fault(&self, request: &RenderRequest) -> Option<String> {
        let shading = &request.shading;
        let [method, diffuse] = [shading.method.name, shading.diffuse.name];
        let levels = shading.precompute.prefilter_level_count;
        match (self.intermediate, self.level) {
            (Intermediate::Prefiltered, _) if !shading.method.uses_prefiltered() => Some(format!(
                "method {method} reads no prefiltered map; expected a split sum"
            )),
            (Intermediate::Prefiltered, Some(level)) if level >= levels => Some(format!(
                "the prefiltered map has the levels 0 to {}, not {level}",
                levels - 1
            )),
            (Intermediate::Dfg, _) if !request.needs_dfg() => Some(format!(
                "method {method} with diffuse {diffuse} reads no DFG table"
            )),
            (Intermediate::Irradiance, _)
                if !shading.diffuse.uses_irradiance_map && shading.diffuse.sh9.is_none() =>
            {
                Some(format!("diffuse {diffuse} reads no irradiance"))
            }
            _ => None,
        }
    }
}

/// How a picture shows values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Display {
    /// By the tone curve of the image.
    Radiance,
    /// Encoded as sRGB.
    Color,
    /// 0 to 1 as black to white, linear.
    Fraction,
    /// -1 to 1 as black to white, linear.
    Direction,
    /// The extent of each coordinate as black to white, linear.
    Extent,
}

/// The values of an intermediate. Scalars are grey.
#[derive(Clone, Debug)]
pub struct IntermediateImage {
    pub values: RgbImage,
    /// 1 where there is a value, else 0; values are 0 there.
    pub mask: Arc<GrayImage>,
    display: Display,
}

impl Pipeline {
    /// Renders what lies between the scene and the image of `request`, in an image of its size:
    /// attachments by pixel, maps as lat-longs (looked up linearly, as shading does), as large as
    /// the image has room for. Panics where [`Selection::fault`] names a fault.
    pub fn intermediate(
        &mut self,
        request: &RenderRequest,
        selection: Selection,
    ) -> Result<IntermediateImage, PipelineError> {
        assert_eq!(selection.fault(request), None);
        self.with_memory(|pipeline| pipeline.read_intermediate(request, selection))
    }

    fn read_intermediate(
        &mut self,
        request: &RenderRequest,
        selection: Selection,
    ) -> Result<IntermediateImage, PipelineError> {
        let maps = match selection.intermediate {
            Intermediate::Irradiance => self.irradiance(request)?,
            Intermediate::Prefiltered => self.prefiltered_levels(request, selection.level)?,
            Intermediate::Dfg => self.dfg_square(request)?,
            attachment => return self.attachment(request, attachment),
        };
        Ok(maps.image(request.size))
    }

    fn attachment(
        &mut self,
        request: &RenderRequest,
        attachment: Intermediate,
    ) -> Result<IntermediateImage, PipelineError> {
        let request = if attachment == Intermediate::Occlusion {
            &RenderRequest {
                scene: Arc::new(request.scene.occlusions()),
                ..request.clone()
            }
        } else {
            request
        };
        let (_, target) = self.resources.view(&self.gpu, request)?;
        let gbuffer = target.gbuffer.read(&self.gpu)?;
        let (values, display) = attachment_values(&gbuffer, attachment);
        Ok(IntermediateImage {
            values,
            mask: target.mask.clone(),
            display,
        })
    }

    fn irradiance(&mut self, request: &RenderRequest) -> Result<Tiles, PipelineError> {
        let prepared = self.prepare(request)?;
        if request.shading.diffuse.uses_irradiance_map {
            let map = self.one_level(&prepared.tables.irradiance_map, 0, request)?;
            return Ok(Tiles::maps(vec![Box::new(move |d| map.value(d, 0.0))]));
        }
        let coefficients: Vec<[f32; 4]> = self.gpu.read_buffer(&prepared.tables.sh9)?;
        let coefficients = std::array::from_fn(|k| Vec3::from_slice(&coefficients[k]).as_dvec3());
        let over_pi = move |n: DVec3| spherical_harmonics::irradiance(&coefficients, n) / PI;
        Ok(Tiles::maps(vec![Box::new(over_pi)]))
    }

    fn prefiltered_levels(
        &mut self,
        request: &RenderRequest,
        level: Option<u32>,
    ) -> Result<Tiles, PipelineError> {
        let Prepared { tables, .. } = self.prepare(request)?;
        let levels = match level {
            Some(level) => level..level + 1,
            None => 0..tables.prefiltered.mip_count(),
        };
        let maps = levels.map(|level| {
            let map = self.one_level(&tables.prefiltered, level, request)?;
            let value: TileValue = Box::new(move |d| map.value(d, 0.0));
            Ok(value)
        });
        Ok(Tiles::maps(maps.collect::<Result<_, PipelineError>>()?))
    }

    fn one_level(
        &self,
        image: &Image,
        level: u32,
        request: &RenderRequest,
    ) -> Result<FilteredMap, PipelineError> {
        let stacked = read_level(&self.gpu, image, level)?;
        let height = stacked.height / image.face_count();
        let face = |face: u32| {
            Pixels::from_fn(stacked.width, height, |x, y| {
                Vec3::from_array(stacked.get(x, y + face * height)).as_dvec3()
            })
        };
        Ok(FilteredMap {
            layout: request.shading.precompute.layout,
            levels: vec![(0..image.face_count()).map(face).collect()],
        })
    }

    fn dfg_square(&mut self, request: &RenderRequest) -> Result<Tiles, PipelineError> {
        let table = self.prepare(request)?.tables.dfg;
        let texels = read_texels(&self.gpu, &table)?;
        let value = move |at: DVec3| {
            let texel = |share: f64, side: u32| ((share * f64::from(side)) as u32).min(side - 1);
            let [a, b, ..] = texels.get(texel(at.x, texels.width), texel(at.y, texels.height));
            DVec3::new(a.into(), b.into(), 0.0)
        };
        Ok(Tiles {
            values: vec![Box::new(value)],
            aspect: 1,
            position: |u, v| DVec3::new(u, v, 0.0),
            display: Display::Fraction,
        })
    }
}

/// The value of a tile at a position of it.
type TileValue = Box<dyn Fn(DVec3) -> DVec3>;

/// Maps that share an image, in rows from the top left.
struct Tiles {
    values: Vec<TileValue>,
    /// Width over height of a tile.
    aspect: u32,
    /// What `values` take, by the share of the width and of the height.
    position: fn(f64, f64) -> DVec3,
    display: Display,
}

impl Tiles {
    /// Radiance by direction, as lat-longs.
    fn maps(values: Vec<TileValue>) -> Self {
        Self {
            values,
            aspect: 2,
            position: |u, v| direction_from_uv(DVec2::new(u, v)),
            display: Display::Radiance,
        }
    }

    /// Draws the tiles as large as an image of `size` pixels has room for.
    fn image(self, size: [u32; 2]) -> IntermediateImage {
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
            display: self.display,
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

/// Reads an attachment, and how to show it.
fn attachment_values(gbuffer: &Gbuffer<f32>, attachment: Intermediate) -> (RgbImage, Display) {
    let rgb = |texels: &Pixels<[f32; 4]>| texels.map(|[r, g, b, _]| [r, g, b]);
    let grey = |texels: &Pixels<[f32; 4]>| texels.map(|[_, _, _, a]| [a; 3]);
    match attachment {
        Intermediate::Position => (rgb(&gbuffer.position_mask), Display::Extent),
        Intermediate::Normal => (rgb(&gbuffer.normal_alpha), Display::Direction),
        Intermediate::Albedo => (rgb(&gbuffer.albedo_metallic), Display::Color),
        Intermediate::F0 => (rgb(&gbuffer.f0_material), Display::Color),
        Intermediate::Alpha => (grey(&gbuffer.normal_alpha), Display::Fraction),
        Intermediate::Metallic => (grey(&gbuffer.albedo_metallic), Display::Fraction),
        Intermediate::Occlusion => {
            let red = |[r, ..]: [f32; 4]| [r; 3];
            (gbuffer.albedo_metallic.map(red), Display::Fraction)
        }
        Intermediate::Irradiance | Intermediate::Prefiltered | Intermediate::Dfg => {
            unreachable!("tables are read elsewhere")
        }
    }
}

impl IntermediateImage {
    /// Paints the values; `ground` where there is none.
    pub fn picture(
        &self,
        pipeline: &mut Pipeline,
        curve: ToneCurve,
        ground: [u8; 3],
    ) -> Result<Rgb8Image, PipelineError> {
        let mut picture = match self.display {
            Display::Radiance => pipeline.tonemap(&self.values, curve)?.0,
            Display::Color => self.encoded(|_, value| srgb_encode(value)),
            Display::Fraction => self.encoded(|_, value| value),
            Display::Direction => self.encoded(|_, value| 0.5 * value + 0.5),
            Display::Extent => {
                let extents: [Extent; 3] = std::array::from_fn(|axis| self.extent(axis));
                self.encoded(|axis, value| extents[axis].share(value))
            }
        };
        for (color, covered) in picture.data.iter_mut().zip(&self.mask.data) {
            if *covered == 0.0 {
                *color = ground;
            }
        }
        Ok(picture)
    }

    /// Eight bits of each channel of a function of its index and value; clamped to 0 and 1.
    fn encoded(&self, signal: impl Fn(usize, f32) -> f32) -> Rgb8Image {
        self.values.map(|rgb| {
            std::array::from_fn(|channel| {
                (255.0 * signal(channel, rgb[channel]).clamp(0.0, 1.0)).round() as u8
            })
        })
    }

    /// The least and the largest coordinate of covered pixels.
    fn extent(&self, axis: usize) -> Extent {
        let covered = self.values.data.iter().zip(&self.mask.data);
        let values = covered
            .filter(|(_, covered)| **covered > 0.0)
            .map(|(rgb, _)| rgb[axis]);
        values.fold(
            Extent {
                min: f32::INFINITY,
                max: f32::NEG_INFINITY,
            },
            |extent, value| Extent {
                min: extent.min.min(value),
                max: extent.max.max(value),
            },
        )
    }
}

#[derive(Clone, Copy)]
struct Extent {
    min: f32,
    max: f32,
}

impl Extent {
    /// Where a value lies, 0 to 1; the middle in an extent of one value.
    fn share(self, value: f32) -> f32 {
        let length = self.max - self.min;
        if length > 0.0 {
            (value - self.min) / length
        } else {
            0.5
        }
    }
}
