//! Output for each engine as data ([`super::convention::PRESETS`]).

/// The files that `splitsum bake --for` writes, beside the table of two taps.
#[derive(Debug)]
pub struct Product {
    /// Name after `--for`.
    pub engine: &'static str,
    /// One sentence for help and docs.
    pub about: &'static str,
    /// Prefiltered map: a container by its extension, else a folder of EXR faces.
    pub specular: &'static str,
    /// Irradiance map; `None` if the engine uses SH.
    pub irradiance: Option<&'static str>,
    /// Files of the DFG table.
    pub tables: &'static [&'static str],
    /// Shading language of the lines to paste.
    pub language: &'static str,
    /// SH as cmgen's text.
    pub sh: Option<&'static str>,
    /// Default pixel format of the cubes.
    pub texel: &'static str,
    /// Whether KTX 2 levels are compressed by zstd.
    pub is_packed: bool,
    pub chain: Chain,
}

/// Side of the last level, texels. Fewer are too few for lookups at alpha 1; more leave too few levels below alpha 0.2
/// (docs/bakes.md).
pub const LAST_SIDE: u32 = 8;

#[derive(Clone, Copy, Debug)]
pub enum Chain {
    /// Halves down to this side, two at least, by default.
    DownTo(u32),
    /// The number of levels that the engine's shaders assume.
    Exactly(u32),
}

impl Product {
    /// Most common values; presets override the others.
    pub(super) const PLAIN: Self = Self {
        engine: "",
        about: "",
        specular: "specular.ktx2",
        irradiance: None,
        tables: &[],
        language: "GLSL",
        sh: None,
        texel: "rgba16f",
        is_packed: false,
        chain: Chain::DownTo(LAST_SIDE),
    };
}

impl Chain {
    pub fn level_count(self, side: u32) -> u32 {
        match self {
            Self::DownTo(least) => (side / least).max(2).ilog2() + 1,
            Self::Exactly(count) => count,
        }
    }
}
