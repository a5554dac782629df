//! Output for each engine as data ([`super::convention::PRESETS`]).

use serde::Deserialize;

/// The files that `splitsum bake --for` writes, beside the table of two taps.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Product {
    /// Name after `--for`.
    pub engine: &'static str,
    /// One sentence for help and docs.
    pub about: &'static str,
    /// Prefiltered map: a container by its extension, else a folder of EXR faces.
    pub specular: &'static str,
    /// Irradiance map; `None` if the engine uses SH.
    #[serde(borrow = "'static")]
    pub irradiance: Option<&'static str>,
    /// Files of the DFG table.
    #[serde(borrow = "'static")]
    pub tables: Vec<&'static str>,
    /// Shading language of the lines to paste.
    pub language: &'static str,
    /// SH as cmgen's text.
    #[serde(borrow = "'static")]
    pub sh: Option<&'static str>,
    /// Default pixel format of the cubes.
    pub texel: &'static str,
    /// Whether KTX 2 levels are compressed by zstd.
    pub is_packed: bool,
    /// Side down to which levels halve by default, texels; two levels at least.
    pub last_side: u32,
    /// The number of levels that the engine's shaders assume, instead.
    pub level_count: Option<u32>,
}

/// Side of the last level, texels. Fewer are too few for lookups at alpha 1; more leave too few levels below alpha 0.2
/// (docs/bakes.md).
pub const LAST_SIDE: u32 = 8;

impl Default for Product {
    /// The most common values.
    fn default() -> Self {
        Self {
            engine: "",
            about: "",
            specular: "specular.ktx2",
            irradiance: None,
            tables: Vec::new(),
            language: "GLSL",
            sh: None,
            texel: "rgba16f",
            is_packed: false,
            last_side: LAST_SIDE,
            level_count: None,
        }
    }
}

impl Product {
    /// Returns the default number of levels for faces of `side` texels.
    pub fn levels(&self, side: u32) -> u32 {
        self.level_count.unwrap_or_else(|| (side / self.last_side).max(2).ilog2() + 1)
    }
}
