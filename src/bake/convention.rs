//! Meaning of a bake's numbers as data: conventions by name, and presets of known tools.

use super::babylon_env;
use super::container::ByteColor;
use super::level_law::LevelLaw;
use super::map_form::MapForm;
use super::playcanvas_atlas;
use super::product::{LAST_SIDE, Product, SIDE};
#[cfg(feature = "cli")]
use crate::base::files::{RECORD_BYTES_MAX, read_text};
use crate::base::names::{Listed, listed};
use crate::instrument::brdf::MaskingShadowing;
use crate::instrument::precompute::prefilter::{LevelMapping, LevelSpacing, WEIGHTS, Weight};
use glam::{BVec2, DVec2, DVec3, Vec2Swizzles};
use serde::Deserialize;
use std::fmt;
use std::path::Path;
use std::sync::LazyLock;

/// World axes in file axes: in `-z+y+x` the world's x is the file's -z. A file's own axes are the
/// axes of a Vulkan cube map, or of our lat-long map ([`crate::base::math::equirect`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Axes {
    /// File axis of each world axis.
    file_axes: [FileAxis; 3],
}

/// A signed axis of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct FileAxis {
    /// 0 for x.
    index: usize,
    is_negative: bool,
}

impl FileAxis {
    const fn positive(index: usize) -> Self {
        Self {
            index,
            is_negative: false,
        }
    }

    fn sign(self) -> f64 {
        if self.is_negative { -1.0 } else { 1.0 }
    }
}

impl Axes {
    pub const SAME: Self = Self {
        file_axes: [
            FileAxis::positive(0),
            FileAxis::positive(1),
            FileAxis::positive(2),
        ],
    };

    /// Parses a text such as `-z+y+x`.
    pub fn parse(text: &str) -> Result<Self, String> {
        Self::all().find(|axes| axes.to_string() == text).ok_or_else(|| {
            format!(
                "{text:?} is not a list of axes; expected the file's axis for the world's x, y and \
                 z, such as +x+y+z or -z+y+x"
            )
        })
    }

    /// Lists all 48 orientations, mirrors included.
    pub fn all() -> impl Iterator<Item = Self> {
        let orders = [
            [0, 1, 2],
            [0, 2, 1],
            [1, 0, 2],
            [1, 2, 0],
            [2, 0, 1],
            [2, 1, 0],
        ];
        orders.into_iter().flat_map(|order| {
            (0..8).map(move |signs| Self {
                file_axes: std::array::from_fn(|i| FileAxis {
                    index: order[i],
                    is_negative: signs >> i & 1 == 1,
                }),
            })
        })
    }

    /// Converts a world direction to the file. Inverse: [`Self::to_world`].
    pub fn to_file(self, world: DVec3) -> DVec3 {
        let mut file = DVec3::ZERO;
        for (axis, value) in self.file_axes.into_iter().zip(world.to_array()) {
            file[axis.index] = axis.sign() * value;
        }
        file
    }

    /// Converts a file direction to the world. Inverse: [`Self::to_file`].
    pub fn to_world(self, file: DVec3) -> DVec3 {
        DVec3::from_array(self.file_axes.map(|axis| axis.sign() * file[axis.index]))
    }
}

impl fmt::Display for Axes {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        for axis in self.file_axes {
            let sign = if axis.is_negative { '-' } else { '+' };
            write!(f, "{sign}{}", ["x", "y", "z"][axis.index])?;
        }
        Ok(())
    }
}

/// Directions of a DFG table's parameters.
#[derive(Debug)]
pub struct TableAxes {
    /// Parameter to the right, then downwards: `n` for n·v, `r` for perceptual roughness, `-` if it
    /// falls.
    pub name: &'static str,
    /// Whether roughness is to the right.
    is_swapped: bool,
    /// Whether the parameters to the right and downwards fall.
    falls: BVec2,
}

impl TableAxes {
    const fn new(name: &'static str, is_swapped: bool, falls: [bool; 2]) -> Self {
        Self {
            name,
            is_swapped,
            falls: BVec2::new(falls[0], falls[1]),
        }
    }
}

/// Every variant; the first is ours.
pub static TABLE_AXES: &[TableAxes] = &[
    TableAxes::new("n+r+", false, [false, false]),
    TableAxes::new("n+r-", false, [false, true]),
    TableAxes::new("n-r+", false, [true, false]),
    TableAxes::new("n-r-", false, [true, true]),
    TableAxes::new("r+n+", true, [false, false]),
    TableAxes::new("r+n-", true, [false, true]),
    TableAxes::new("r-n+", true, [true, false]),
    TableAxes::new("r-n-", true, [true, true]),
];

impl TableAxes {
    /// Returns n·v and perceptual roughness at texture coordinates. Inverse: [`Self::uv`].
    pub fn parameters(&self, uv: DVec2) -> DVec2 {
        self.swapped(self.flipped(uv))
    }

    /// Returns texture coordinates of n·v and perceptual roughness. Inverse: [`Self::parameters`].
    pub fn uv(&self, parameters: DVec2) -> DVec2 {
        self.flipped(self.swapped(parameters))
    }

    fn flipped(&self, uv: DVec2) -> DVec2 {
        DVec2::select(self.falls, 1.0 - uv, uv)
    }

    fn swapped(&self, pair: DVec2) -> DVec2 {
        if self.is_swapped { pair.yx() } else { pair }
    }
}

/// Content of a DFG table's first two channels: scale A of F0 and bias B.
#[derive(Debug)]
pub struct TableChannels {
    pub name: &'static str,
    /// Converts the channels to A and B.
    pub pair: fn(DVec2) -> DVec2,
}

/// Every variant; the first is ours.
pub static TABLE_CHANNELS: &[TableChannels] = &[
    TableChannels {
        name: "scale-bias",
        pair: |texel| texel,
    },
    TableChannels {
        name: "bias-scale",
        pair: |texel| texel.yx(),
    },
    // Filament's table for several scatterings.
    TableChannels {
        name: "bias-albedo",
        pair: |texel| DVec2::new(texel.y - texel.x, texel.x),
    },
];

/// Widest level of a bake. The BRDF's widths end at 1; a few engines filter wider.
pub const ALPHA_MAX: f64 = 16.0;

/// How to read the numbers of a bake.
#[derive(Clone, Debug)]
pub struct Convention {
    pub axes: Axes,
    /// Perceptual roughness of each level, unless `alphas` is set.
    pub mapping: &'static LevelMapping,
    pub alphas: Option<Vec<f64>>,
    /// Levels per doubling of the width, in a chain down to one texel whose level k has the width
    /// `2^(k/s)/n`, n the side of level 0; replaces the mapping.
    pub levels_per_doubling: Option<f64>,
    /// A formula of the widths; replaces the mapping, too.
    pub level_law: Option<&'static LevelLaw>,
    /// Radiance of a texel of 1.
    pub scale: f64,
    /// Irradiance over π of a texel of 1 in an irradiance map.
    pub irradiance_scale: f64,
    pub table_axes: &'static TableAxes,
    pub table_channels: &'static TableChannels,
    pub masking: MaskingShadowing,
    /// Weight of a direction in a texel's mean.
    pub weight: &'static Weight,
    /// What texels of four bytes hold; `None` if the tool writes none.
    pub byte_color: Option<ByteColor>,
}

/// The conventions of a tool: one of `assets/bakes/presets.json`, or a TOML file of the user.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Preset {
    pub name: &'static str,
    pub about: &'static str,
    /// Program or repository with version, file and function.
    pub source: &'static str,
    axes: &'static str,
    level_mapping: &'static str,
    alphas: Option<Vec<f64>>,
    levels_per_doubling: Option<f64>,
    level_law: Option<&'static str>,
    scale: f64,
    irradiance_scale: f64,
    table_axes: &'static str,
    table_channels: &'static str,
    masking: &'static str,
    weight: &'static str,
    bytes: Option<&'static str>,
    product: Option<Product>,
}

impl Default for Preset {
    fn default() -> Self {
        Self {
            name: "",
            about: "",
            source: "",
            axes: "+x+y+z",
            level_mapping: "linear",
            alphas: None,
            levels_per_doubling: None,
            level_law: None,
            scale: 1.0,
            irradiance_scale: 1.0,
            table_axes: TABLE_AXES[0].name,
            table_channels: TABLE_CHANNELS[0].name,
            masking: "correlated",
            weight: WEIGHTS[0].name,
            bytes: None,
            product: None,
        }
    }
}

/// Every preset; the first is the default.
pub static PRESETS: LazyLock<Vec<Preset>> = LazyLock::new(|| {
    serde_json::from_str(include_str!("../../assets/bakes/presets.json"))
        .expect("the file is part of the program")
});

listed!(TableAxes, "order of table axes", TABLE_AXES);
listed!(TableChannels, "order of table channels", TABLE_CHANNELS);
listed!(
    Preset,
    "preset",
    PRESETS,
    /// Finds a preset by its name or its engine's.
    fn by_name(name: &str) -> Option<&'static Self> {
        Self::all().find(|preset| {
            preset.name == name || preset.has_product() && preset.product().engine == name
        })
    }
);

impl Preset {
    /// Finds a listed preset, or reads a user's from a TOML file relative to `dir`.
    pub fn open(name: &str, dir: &Path) -> Result<&'static Self, String> {
        let Some(stem) = name.strip_suffix(".toml") else {
            return Self::parse(name);
        };
        Self::from_toml(&dir.join(name), stem)
    }

    #[cfg(feature = "cli")]
    fn from_toml(path: &Path, name: &str) -> Result<&'static Self, String> {
        let toml = read_text(path, RECORD_BYTES_MAX)
            .map_err(|error| format!("{}: {error}; expected a TOML file", path.display()))?;
        let mut table: toml::Table = toml::from_str(&toml).map_err(|error| error.to_string())?;
        table.entry("name").or_insert_with(|| name.into());
        Self::from_json(serde_json::to_string(&table).map_err(|error| error.to_string())?)
    }

    #[cfg(not(feature = "cli"))]
    fn from_toml(path: &Path, _name: &str) -> Result<&'static Self, String> {
        let path = path.display();
        Err(format!(
            "{path}: TOML presets need a build with the feature cli"
        ))
    }

    /// Reads a user's preset from JSON. Fails on an unknown field, name or number.
    pub fn from_json(text: String) -> Result<&'static Self, String> {
        // The text is never freed, as listed presets are not. Its line and column are not the
        // user's.
        let preset: Result<Self, _> = serde_json::from_str(text.leak());
        let preset = preset.map_err(|error| {
            error
                .to_string()
                .split(" at line ")
                .next()
                .unwrap_or_default()
                .to_owned()
        })?;
        preset.parsed()?;
        if let Some(product) = &preset.product {
            if preset.scale != 1.0 {
                return Err("scale: a preset with [product] writes radiance; leave it out".into());
            }
            if preset.level_law.is_some() {
                return Err("level_law: a preset with [product] needs alphas or a mapping".into());
            }
            if let Some(alphas) = &preset.alphas {
                preset.convention().spacing(alphas.len())?;
                if product.level_count != Some(alphas.len() as u32) {
                    return Err(format!(
                        "alphas: {} widths; a preset with [product] needs level_count = {0}",
                        alphas.len()
                    ));
                }
            }
            product
                .check()
                .map_err(|fault| format!("product.{fault}"))?;
        }
        Ok(Box::leak(Box::new(preset)))
    }

    /// Lists the presets for which `splitsum bake --for` writes files.
    pub fn engines() -> impl Iterator<Item = &'static Self> {
        PRESETS.iter().filter(|preset| preset.has_product())
    }

    pub fn has_product(&self) -> bool {
        self.product.is_some()
    }

    /// Returns the output of `splitsum bake --for`. Panics without [`Self::has_product`].
    pub fn product(&self) -> &Product {
        self.product.as_ref().expect("the preset has files")
    }

    /// Returns the default side of a face, texels: the last level that the engine reads has
    /// [`LAST_SIDE`].
    pub fn side(&self) -> u32 {
        if let MapForm::PlayCanvasAtlas = MapForm::of(self.product().specular) {
            return playcanvas_atlas::SIDE;
        }
        let count = self
            .product()
            .level_count
            .or(self.convention().mapping.engine_levels);
        count.map_or(SIDE, |count| SIDE.max(LAST_SIDE << (count - 1)))
    }

    /// Returns the conventions with parsed names.
    pub fn convention(&self) -> Convention {
        self.parsed().expect("checked where it was read")
    }

    fn parsed(&self) -> Result<Convention, String> {
        let positive = [
            Some(self.scale),
            Some(self.irradiance_scale),
            self.levels_per_doubling,
        ];
        if let Some(bad) = positive
            .iter()
            .flatten()
            .find(|scale| !(scale.is_finite() && **scale > 0.0))
        {
            return Err(format!(
                "a scale of {bad}; expected a finite number above 0"
            ));
        }
        if let Some(alphas) = self
            .alphas
            .as_ref()
            .filter(|all| !all.is_sorted() || all.iter().any(|x| !(0.0..=ALPHA_MAX).contains(x)))
        {
            return Err(format!(
                "alphas: {alphas:?}; expected ascending widths from 0 to {ALPHA_MAX}"
            ));
        }
        Ok(Convention {
            axes: Axes::parse(self.axes)?,
            mapping: LevelMapping::parse(self.level_mapping)?,
            alphas: self.alphas.clone(),
            levels_per_doubling: self.levels_per_doubling,
            level_law: self.level_law.map(LevelLaw::parse).transpose()?,
            scale: self.scale,
            irradiance_scale: self.irradiance_scale,
            table_axes: TableAxes::parse(self.table_axes)?,
            table_channels: TableChannels::parse(self.table_channels)?,
            masking: *MaskingShadowing::parse(self.masking)?,
            weight: Weight::parse(self.weight)?,
            byte_color: self.bytes.map(ByteColor::parse).transpose()?.copied(),
        })
    }
}

impl Convention {
    /// Returns the width of each of `count` levels.
    pub fn alphas(&self, count: usize) -> Result<Vec<f64>, String> {
        if let (None, Some(scale)) = (&self.alphas, self.levels_per_doubling) {
            return Ok(babylon_env::alphas(1 << (count - 1), count, scale));
        }
        if let (None, Some(law)) = (&self.alphas, self.level_law) {
            return Ok(law.alphas(count));
        }
        match &self.alphas {
            Some(alphas) if alphas.len() == count && alphas.is_sorted() => Ok(alphas.clone()),
            Some(alphas) if alphas.len() == count => {
                Err("--alphas: expected ascending widths".to_owned())
            }
            Some(all) => Err(format!(
                "widths: {}, levels: {count}; --level-mapping tells what is missing",
                all.len()
            )),
            None if count == 1 => Ok(vec![0.0]),
            None => {
                let last = self.mapping_levels(count);
                Ok((0..count as u32)
                    .map(|level| {
                        self.mapping
                            .alpha_from_mip(level.min(last - 1).into(), last)
                    })
                    .collect())
            }
        }
    }

    /// Returns the roughness of `count` levels for lookups: of listed widths, else by the mapping.
    pub fn spacing(&self, count: usize) -> Result<LevelSpacing, String> {
        match &self.alphas {
            Some(alphas) => {
                let roughnesses: Vec<f64> = alphas.iter().map(|alpha| alpha.sqrt()).collect();
                LevelSpacing::listed(&roughnesses)
            }
            None => Ok(LevelSpacing {
                mapping: self.mapping,
                level_count: self.mapping_levels(count),
            }),
        }
    }

    /// Whether widths follow from a mapping of levels.
    pub fn has_mapping(&self) -> bool {
        self.alphas.is_none() && self.levels_per_doubling.is_none() && self.level_law.is_none()
    }

    /// Returns the number of levels that the engine reads of `count`.
    pub fn mapping_levels(&self, count: usize) -> u32 {
        if let Some(scale) = self.levels_per_doubling {
            // The level of width 1, and the next, which lookups blend with it.
            let last = (scale * (count as f64 - 1.0)).ceil();
            return (last as u32 + 1).min(count as u32);
        }
        self.mapping.engine_levels.unwrap_or(count as u32)
    }
}
