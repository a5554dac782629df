//! Meaning of a bake's numbers as data: conventions by name, and presets of known tools.

use super::product::{Chain, Product};
use crate::brdf::MaskingShadowing;
use crate::precompute::prefilter::LevelMapping;
use crate::spelling::Listed;
use crate::spelling::listed;
use glam::{DVec2, DVec3};
use std::fmt;

/// World axes in file axes: in `-z+y+x` the world's x is the file's -z. A file's own axes are the axes of a Vulkan cube
/// map, or of our lat-long map ([`crate::math::equirect`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Axes {
    /// File axis of each world axis, and whether it is negated.
    of: [(usize, bool); 3],
}

impl Axes {
    pub const SAME: Self = Self { of: [(0, false), (1, false), (2, false)] };

    /// Parses a text such as `-z+y+x`.
    pub fn parse(text: &str) -> Result<Self, String> {
        Self::all().find(|axes| axes.to_string() == text).ok_or_else(|| {
            format!(
                "{text:?} is not a list of axes; expected the file's axis for the world's x, y and z, such as +x+y+z or -z+y+x"
            )
        })
    }

    /// Lists all 48 orientations, mirrors included.
    pub fn all() -> impl Iterator<Item = Self> {
        let orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
        orders.into_iter().flat_map(|order| {
            (0..8).map(move |signs| Self { of: std::array::from_fn(|i| (order[i], signs >> i & 1 == 1)) })
        })
    }

    /// Converts a world direction to the file. Inverse: [`Self::to_world`].
    pub fn to_file(self, world: DVec3) -> DVec3 {
        let mut file = DVec3::ZERO;
        (0..3).for_each(|i| file[self.of[i].0] = self.sign(i) * world[i]);
        file
    }

    /// Converts a file direction to the world. Inverse: [`Self::to_file`].
    pub fn to_world(self, file: DVec3) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|i| self.sign(i) * file[self.of[i].0]))
    }

    pub fn is_mirror(self) -> bool {
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| self.to_world(axis));
        x.cross(y).dot(z) < 0.0
    }

    fn sign(self, i: usize) -> f64 {
        if self.of[i].1 { -1.0 } else { 1.0 }
    }
}

impl fmt::Display for Axes {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.of.iter().try_for_each(|(axis, is_turned)| {
            write!(f, "{}{}", if *is_turned { '-' } else { '+' }, ["x", "y", "z"][*axis])
        })
    }
}

/// Directions of a DFG table's parameters.
#[derive(Debug)]
pub struct TableAxes {
    /// Parameter to the right, then downwards: `n` for n·v, `r` for perceptual roughness, `-` if it falls.
    pub name: &'static str,
    is_transposed: bool,
    falls: [bool; 2],
}

const fn table_axes(name: &'static str, is_transposed: bool, falls: [bool; 2]) -> TableAxes {
    TableAxes { name, is_transposed, falls }
}

/// Every variant; the first is ours.
pub static TABLE_AXES: &[TableAxes] = &[
    table_axes("n+r+", false, [false, false]),
    table_axes("n+r-", false, [false, true]),
    table_axes("n-r+", false, [true, false]),
    table_axes("n-r-", false, [true, true]),
    table_axes("r+n+", true, [false, false]),
    table_axes("r+n-", true, [false, true]),
    table_axes("r-n+", true, [true, false]),
    table_axes("r-n-", true, [true, true]),
];

impl TableAxes {
    /// Returns n·v and perceptual roughness at texture coordinates.
    pub fn parameters(&self, uv: DVec2) -> DVec2 {
        let [u, v] = [(uv.x, self.falls[0]), (uv.y, self.falls[1])].map(|(t, falls)| if falls { 1.0 - t } else { t });
        if self.is_transposed { DVec2::new(v, u) } else { DVec2::new(u, v) }
    }

    /// Returns texture coordinates of n·v and perceptual roughness. Inverse: [`Self::parameters`].
    pub fn place(&self, parameters: DVec2) -> DVec2 {
        let at = if self.is_transposed { DVec2::new(parameters.y, parameters.x) } else { parameters };
        let [u, v] = [(at.x, self.falls[0]), (at.y, self.falls[1])].map(|(t, falls)| if falls { 1.0 - t } else { t });
        DVec2::new(u, v)
    }
}

/// Content of a DFG table's first two channels: scale A of F0 and bias B.
#[derive(Debug)]
pub struct TableChannels {
    pub name: &'static str,
    pub about: &'static str,
    /// Converts the channels to A and B.
    pub pair: fn(DVec2) -> DVec2,
}

/// Every variant; the first is ours.
pub static TABLE_CHANNELS: &[TableChannels] = &[
    TableChannels { name: "scale-bias", about: "A, B", pair: |texel| texel },
    TableChannels { name: "bias-scale", about: "B, A", pair: |texel| DVec2::new(texel.y, texel.x) },
    TableChannels {
        name: "bias-albedo",
        about: "B, A + B: Filament's table for several scatterings",
        pair: |texel| DVec2::new(texel.y - texel.x, texel.x),
    },
];

#[derive(Clone, Debug)]
pub struct Convention {
    pub axes: Axes,
    /// Perceptual roughness of each level, unless `alphas` is set.
    pub mapping: &'static LevelMapping,
    /// Width of each level.
    pub alphas: Option<Vec<f64>>,
    /// Radiance of a texel of 1.
    pub scale: f64,
    /// Irradiance over π of a texel of 1 in an irradiance map.
    pub irradiance_scale: f64,
    pub table_axes: &'static TableAxes,
    pub table_channels: &'static TableChannels,
    pub masking: MaskingShadowing,
}

#[derive(Debug)]
pub struct Preset {
    pub name: &'static str,
    pub about: &'static str,
    axes: &'static str,
    mapping: &'static str,
    table_axes: &'static str,
    pub masking: MaskingShadowing,
    /// Output of `splitsum bake --for`.
    pub product: Product,
}

/// Most common values; presets override the others.
const PLAIN: Preset = Preset {
    name: "",
    about: "",
    axes: "+x+y+z",
    mapping: "linear",
    table_axes: "n+r+",
    masking: MaskingShadowing::Correlated,
    product: Product::PLAIN,
};

/// Every preset; the first is the default.
pub static PRESETS: &[Preset] = &[
    Preset {
        name: "splitsum",
        about: "the files of splitsum bake, with bake.json",
        masking: MaskingShadowing::Separable,
        product: Product {
            engine: "raw",
            about: "faces as 32-bit EXR (+x -x +y -y +z -z) and the table in four formats, for your own importer",
            specular: "specular",
            irradiance: Some("diffuse"),
            tables: &["dfg.exr", "dfg.ktx2", "dfg.dds", "dfg.png"],
            sh: Some("sh.txt"),
            texel: "rgba32f",
            ..Product::PLAIN
        },
        ..PLAIN
    },
    Preset {
        name: "cmgen",
        about: "Filament's cmgen with its default mirroring; for --no-mirror add --axes=-x+y+z",
        mapping: "quadratic",
        table_axes: "n+r-",
        product: Product {
            engine: "filament",
            about: "one KTX 1 in the form of cmgen; SH is a key in it, and sh.txt",
            specular: "ibl.ktx",
            tables: &["dfg.exr"],
            sh: Some("sh.txt"),
            texel: "r11g11b10f",
            chain: Chain::DownTo(16),
            ..Product::PLAIN
        },
        ..PLAIN
    },
    Preset {
        name: "khronos",
        about: "glTF-IBL-Sampler: roughness level/(levels - 1), y down, a quarter turn from ours",
        axes: "-z+y+x",
        product: Product {
            engine: "khronos",
            about: "two KTX 2 cubes and the table, for the glTF Sample Viewer",
            irradiance: Some("diffuse.ktx2"),
            tables: &["lut_ggx.png"],
            ..Product::PLAIN
        },
        ..PLAIN
    },
    Preset {
        name: "bevy",
        about: "cubes for Bevy's lookup (x, y, -z); checked with pictures of Bevy 0.19.1 and its DFG table",
        axes: "+x+y-z",
        product: Product {
            engine: "bevy",
            about: "two KTX 2 cubes for EnvironmentMapLight (Bevy's features ktx2 and zstd)",
            irradiance: Some("diffuse.ktx2"),
            language: "WGSL",
            texel: "rgb9e5",
            is_packed: true,
            ..Product::PLAIN
        },
        ..PLAIN
    },
    Preset {
        name: "cesium",
        about: "cubes for Cesium's lookup, x east and z south; from its shader, not checked with a bake",
        product: Product {
            engine: "cesium",
            about: "a KTX 2 cube for specularEnvironmentMaps and SH for sphericalHarmonicCoefficients; use both of one run",
            sh: Some("sh.txt"),
            ..Product::PLAIN
        },
        ..PLAIN
    },
    Preset {
        name: "unity",
        about: "left-handed cubes with Unity's 7 levels; from its shaders, not checked with a bake",
        axes: "-x+y+z",
        mapping: "unity",
        product: Product {
            engine: "unity",
            about: "a DDS cube of 7 levels and the table as DDS, for your own importer: Unity filters the maps that it imports",
            specular: "specular.dds",
            tables: &["dfg.dds"],
            language: "HLSL",
            sh: Some("sh.txt"),
            chain: Chain::Exactly(7),
            ..Product::PLAIN
        },
        ..PLAIN
    },
];

listed!(TableAxes, "order of table axes", TABLE_AXES);
listed!(TableChannels, "order of table channels", TABLE_CHANNELS);
listed!(
    Preset,
    "preset",
    PRESETS,
    /// Finds a preset by its name or its engine's.
    fn by_name(name: &str) -> Option<&'static Self> {
        Self::all().find(|preset| preset.name == name || preset.product.engine == name)
    }
);

impl Preset {
    pub fn convention(&self) -> Convention {
        Convention {
            axes: Axes::parse(self.axes).expect("a preset's axes"),
            mapping: LevelMapping::listed(self.mapping),
            alphas: None,
            scale: 1.0,
            irradiance_scale: 1.0,
            table_axes: TABLE_AXES.iter().find(|axes| axes.name == self.table_axes).expect("a preset's table"),
            table_channels: &TABLE_CHANNELS[0],
            masking: self.masking,
        }
    }
}

impl Convention {
    /// Returns the width of each of `count` levels.
    pub fn alphas(&self, count: usize) -> Result<Vec<f64>, String> {
        match &self.alphas {
            Some(alphas) if alphas.len() == count => Ok(alphas.clone()),
            Some(alphas) => Err(format!("{} widths; expected {count}, one for each level", alphas.len())),
            None if count == 1 => Ok(vec![0.0]),
            None => {
                let last = self.mapping_levels(count);
                Ok((0..count as u32)
                    .map(|level| self.mapping.alpha_from_mip(level.min(last - 1).into(), last))
                    .collect())
            }
        }
    }

    /// Returns the number of levels that the mapping assumes.
    pub fn mapping_levels(&self, count: usize) -> u32 {
        self.mapping.engine_levels.unwrap_or(count as u32)
    }
}
