//! What engines take of a bake, as data: one entry a preset ([`super::convention::PRESETS`]).

/// The files that `splitsum bake --for` writes.
#[derive(Debug)]
pub struct Product {
    /// The name after `--for`.
    pub engine: &'static str,
    /// What takes the files, and how; one sentence for help and docs.
    pub about: &'static str,
    /// Name of the prefiltered map: its extension names the container, and without one it is a folder of EXR faces.
    pub specular: &'static str,
    /// The same of the irradiance map, where the engine takes one; others light by SH.
    pub irradiance: Option<&'static str>,
    /// Names of the same DFG table in the forms that are wanted.
    pub tables: &'static [&'static str],
    /// Name of SH, as cmgen's text.
    pub sh: Option<&'static str>,
    /// Pixel format of the cubes, where none is asked for.
    pub texel: &'static str,
    /// Whether KTX 2 packs its levels by zstd.
    pub is_packed: bool,
    pub chain: Chain,
}

/// Texels a side of the last level. Fewer are too few for lookups between them at alpha 1; more leave too few levels below alpha 0.2
/// (docs/bakes.md has the errors).
pub const LAST_SIDE: u32 = 8;

/// Levels of a cube, where no number is asked for.
#[derive(Clone, Copy, Debug)]
pub enum Chain {
    /// Halved down to a side, two at least; other numbers are good, too.
    DownTo(u32),
    /// What the engine's shaders count on.
    Exactly(u32),
}

impl Chain {
    /// Levels of a cube of that side.
    pub fn level_count(self, side: u32) -> u32 {
        match self {
            Self::DownTo(least) => (side / least).max(2).ilog2() + 1,
            Self::Exactly(count) => count,
        }
    }
}
