//! Pictures of what lies between a scene and its image: attachments of the g-buffer, and the tables
//! that the terms of the image read.

mod tiles;

use super::inputs::{DfgInputs, IrradianceInputs, PrefilterInputs, sh9_key};
use super::light_tables::{read_level, read_texels};
use super::resources::Prepared;
use super::{Pipeline, PipelineError, RenderRequest};
use crate::base::color::srgb_encode;
use crate::base::math::spherical_harmonics;
use crate::base::names::{Listed, listed};
use crate::base::pixels::{GrayImage, Pixels, Rgb8Image, RgbImage};
use crate::instrument::environment::layout::{FilteredMap, MapLayout};
use crate::instrument::gbuffer::Gbuffer;
use crate::instrument::gpu::Image;
use crate::instrument::tonemap::ToneCurve;
use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;
use std::fmt;
use std::sync::Arc;
use tiles::{TileValue, Tiles};

/// Widths of lat-longs of [`Selection::fitted_size`], pixels.
const MAP_WIDTH_MIN: u32 = 16;
const MAP_WIDTH_MAX: u32 = 128;
/// Side of its DFG table, which is smooth.
const DFG_SIDE_MAX: u32 = 64;

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

impl Intermediate {
    /// Whether it has a pixel for each pixel of the image.
    pub fn is_attachment(self) -> bool {
        !matches!(self, Self::Irradiance | Self::Prefiltered | Self::Dfg)
    }
}

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

    /// Lists what lies between the scene and the image of `request`, level by level.
    pub fn all(request: &RenderRequest) -> impl Iterator<Item = Self> {
        let level_count = request.shading.precompute.prefilter_level_count;
        let selections = Intermediate::all().flat_map(move |&intermediate| {
            let levels = match intermediate {
                Intermediate::Prefiltered => (0..level_count).map(Some).collect(),
                _ => vec![None],
            };
            levels.into_iter().map(move |level| Self {
                intermediate,
                level,
            })
        });
        selections.filter(|selection| selection.fault(request).is_none())
    }

    /// Returns all that determines the values: requests with equal keys have equal values. Panics
    /// where [`Selection::fault`] names a fault.
    pub fn key(self, request: &RenderRequest) -> String {
        assert_eq!(self.fault(request), None);
        let storage = request.shading.tables().storage.name();
        let inputs = match self.intermediate {
            Intermediate::Prefiltered => PrefilterInputs::from_request(request).key().text(),
            Intermediate::Dfg => DfgInputs::from_request(request).key().text(),
            Intermediate::Irradiance => match request.shading.diffuse.sh9 {
                Some(projection) => sh9_key(&request.environment, projection).text(),
                None => IrradianceInputs::from_request(request).key().text(),
            },
            _ => {
                let RenderRequest {
                    scene,
                    camera,
                    size,
                    ..
                } = request;
                format!("{} {camera:?} {size:?}", scene.hash)
            }
        };
        format!("{self} {storage} {inputs}")
    }

    /// Returns the size of a picture with about one pixel a texel: of a map 16 to 128 pixels
    /// wide, of the DFG table at most 64, of an attachment the size of the image.
    pub fn fitted_size(self, request: &RenderRequest) -> [u32; 2] {
        let made = request.shading.tables();
        let latlong = |texel_count: u32| {
            let width = f64::from(2 * texel_count).sqrt().ceil() as u32;
            let width = width
                .next_power_of_two()
                .clamp(MAP_WIDTH_MIN, MAP_WIDTH_MAX);
            [width, width / 2]
        };
        match self.intermediate {
            Intermediate::Prefiltered => {
                let level = self.level.unwrap_or(0);
                let side = |length: u32| (length >> level).max(1);
                let [width, height] = made.prefilter_size.map(side);
                latlong(made.layout.face_count * width * height)
            }
            Intermediate::Irradiance => {
                let [width, height] = made.irradiance_size;
                latlong(made.layout.face_count * width * height)
            }
            Intermediate::Dfg => [made.dfg_size.min(DFG_SIDE_MAX); 2],
            _ => request.size,
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
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Encoding {
    /// By the tone curve of the image.
    Radiance,
    /// Encoded as sRGB.
    Color,
    /// The extent of each channel as 0 to 1, linear.
    Linear([Extent; 3]),
}

impl Encoding {
    const FRACTION: Self = Self::Linear([Extent { min: 0.0, max: 1.0 }; 3]);
    const DIRECTION: Self = Self::Linear(
        [Extent {
            min: -1.0,
            max: 1.0,
        }; 3],
    );
}

/// The least and the largest value of a channel.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub struct Extent {
    pub min: f32,
    pub max: f32,
}

impl Extent {
    /// The extent of a channel over the pixels of a mask; 0 to 0 if it is empty.
    fn of_channel(values: &RgbImage, mask: &GrayImage, channel: usize) -> Self {
        let covered = values.data.iter().zip(&mask.data);
        let points = covered
            .filter(|(_, covered)| **covered > 0.0)
            .map(|(rgb, _)| Self {
                min: rgb[channel],
                max: rgb[channel],
            });
        let joined = points.reduce(|a, b| Self {
            min: a.min.min(b.min),
            max: a.max.max(b.max),
        });
        joined.unwrap_or(Self { min: 0.0, max: 0.0 })
    }

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

/// The values of an intermediate. Scalars are grey.
#[derive(Clone, Debug)]
pub struct IntermediateImage {
    pub values: RgbImage,
    /// 1 where there is a value, else 0; values are 0 there.
    pub mask: Arc<GrayImage>,
    pub encoding: Encoding,
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
        self.intermediate_of_size(request, selection, request.size)
    }

    /// The same with tables in an image of another size; attachments keep the size of the request.
    pub fn intermediate_of_size(
        &mut self,
        request: &RenderRequest,
        selection: Selection,
        table_size: [u32; 2],
    ) -> Result<IntermediateImage, PipelineError> {
        assert_eq!(selection.fault(request), None);
        self.with_memory(|pipeline| {
            let maps = match selection.intermediate {
                Intermediate::Irradiance => pipeline.irradiance(request)?,
                Intermediate::Prefiltered => {
                    pipeline.prefiltered_levels(request, selection.level)?
                }
                Intermediate::Dfg => pipeline.dfg_square(request)?,
                attachment => return pipeline.attachment(request, attachment),
            };
            Ok(maps.image(table_size))
        })
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
        Ok(IntermediateImage::of_gbuffer(
            &gbuffer,
            target.coverage(&self.gpu)?.mask,
            attachment,
        ))
    }

    fn irradiance(&mut self, request: &RenderRequest) -> Result<Tiles, PipelineError> {
        let prepared = self.prepare(request)?;
        if request.shading.diffuse.uses_irradiance_map {
            let layout = request.shading.precompute.layout;
            let map = self.one_level(&prepared.tables.irradiance_map, 0, layout)?;
            return Ok(Tiles::maps(vec![Box::new(move |d| map.value(d, 0.0))]));
        }
        if request.shading.diffuse.uses_sh9_texture {
            let map = self.one_level(&prepared.tables.sh9_texture, 0, MapLayout::environments())?;
            return Ok(Tiles::maps(vec![Box::new(move |d| map.value(d, 0.0))]));
        }
        let coefficients: Vec<[f32; 4]> = self.gpu.read_buffer(&prepared.tables.sh9)?;
        let coefficients = std::array::from_fn(|k| Vec3::from_slice(&coefficients[k]).as_dvec3());
        // As `shaders/shade/diffuse/sh9.glsl`.
        let over_pi = move |n: DVec3| {
            (spherical_harmonics::irradiance(&coefficients, n) / PI).max(DVec3::ZERO)
        };
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
            let layout = request.shading.precompute.layout;
            let map = self.one_level(&tables.prefiltered, level, layout)?;
            let value: TileValue = Box::new(move |d| map.value(d, 0.0));
            Ok(value)
        });
        Ok(Tiles::maps(maps.collect::<Result<_, PipelineError>>()?))
    }

    fn one_level(
        &self,
        image: &Image,
        level: u32,
        layout: &'static MapLayout,
    ) -> Result<FilteredMap, PipelineError> {
        let stacked = read_level(&self.gpu, image, level)?;
        let height = stacked.height / image.face_count();
        let face = |face: u32| {
            Pixels::from_fn(stacked.width, height, |x, y| {
                Vec3::from_array(stacked.get(x, y + face * height)).as_dvec3()
            })
        };
        Ok(FilteredMap {
            layout,
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
            encoding: Encoding::FRACTION,
        })
    }
}

impl IntermediateImage {
    /// Reads an attachment. Panics on tables, which a g-buffer does not have.
    pub fn of_gbuffer(
        gbuffer: &Gbuffer<f32>,
        mask: Arc<GrayImage>,
        attachment: Intermediate,
    ) -> Self {
        let rgb = |texels: &Pixels<[f32; 4]>| texels.map(|[r, g, b, _]| [r, g, b]);
        let red = |texels: &Pixels<[f32; 4]>| texels.map(|[r, ..]| [r; 3]);
        let alpha = |texels: &Pixels<[f32; 4]>| texels.map(|[_, _, _, a]| [a; 3]);
        let (values, encoding) = match attachment {
            Intermediate::Position => {
                let values = rgb(&gbuffer.position_mask);
                let extents = [0, 1, 2].map(|axis| Extent::of_channel(&values, &mask, axis));
                (values, Encoding::Linear(extents))
            }
            Intermediate::Normal => (rgb(&gbuffer.normal_alpha), Encoding::DIRECTION),
            Intermediate::Albedo => (rgb(&gbuffer.albedo_metallic), Encoding::Color),
            Intermediate::F0 => (rgb(&gbuffer.f0_material), Encoding::Color),
            Intermediate::Alpha => (alpha(&gbuffer.normal_alpha), Encoding::FRACTION),
            Intermediate::Metallic => (alpha(&gbuffer.albedo_metallic), Encoding::FRACTION),
            // The scene of `Scene::occlusions` has it in its albedo.
            Intermediate::Occlusion => (red(&gbuffer.albedo_metallic), Encoding::FRACTION),
            Intermediate::Irradiance | Intermediate::Prefiltered | Intermediate::Dfg => {
                panic!("{} is not an attachment", attachment.name())
            }
        };
        Self {
            values,
            mask,
            encoding,
        }
    }

    /// Paints the values; `ground` where there is none.
    pub fn picture(
        &self,
        pipeline: &mut Pipeline,
        curve: ToneCurve,
        ground: [u8; 3],
    ) -> Result<Rgb8Image, PipelineError> {
        let mut picture = match self.encoding {
            Encoding::Radiance => pipeline.tonemap(&self.values, curve)?.0,
            Encoding::Color => self.encoded(|_, value| srgb_encode(value)),
            Encoding::Linear(extents) => {
                self.encoded(|channel, value| extents[channel].share(value))
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
}
