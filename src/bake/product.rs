//! Output for each engine as data ([`super::convention::PRESETS`]).

use super::container::Texel;
use super::paste::{TAPS, code};
use super::source::MANIFEST;
use crate::base::names::{Listed, not_one_of};
use serde::Deserialize;
use std::path::Path;

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

/// Default side of a face, texels.
pub(super) const SIDE: u32 = 256;
/// Side of the last level, texels. Fewer are too few for lookups at alpha 1; more leave too few
/// levels below alpha 0.2 (docs/bakes.md).
pub const LAST_SIDE: u32 = 8;

impl Default for Product {
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
    /// Fails on a file name that is not a plain name of a form that is written, and on unknown
    /// formats.
    pub fn check(&self) -> Result<(), String> {
        let names = [
            Some(self.specular),
            self.irradiance,
            self.sh,
            Some(TAPS),
            Some(MANIFEST),
        ];
        let names: Vec<&str> = names
            .into_iter()
            .flatten()
            .chain(self.tables.iter().copied())
            .collect();
        let is_plain = |name: &str| {
            Path::new(name).file_name().is_some_and(|own| own == name) && !name.contains('\\')
        };
        for (index, name) in names.iter().enumerate() {
            if !is_plain(name) {
                return Err(format!("{name:?}: expected a file name without a folder"));
            }
            if names[..index].contains(name) {
                return Err(format!("{name:?}: two files have this name"));
            }
        }
        let ends = |key: &str, name: &str, known: &[&str]| {
            let is_known = Path::new(name)
                .extension()
                .is_some_and(|end| known.iter().any(|known| end == *known));
            (!is_known).then(|| format!("{key}: {}", not_one_of("format", name, known, "")))
        };
        let of_map = |key, name: &str| {
            name.contains('.')
                .then(|| ends(key, name, &["ktx2", "ktx", "dds"]))?
        };
        let maps =
            of_map("specular", self.specular).or_else(|| of_map("irradiance", self.irradiance?));
        let mut tables = self
            .tables
            .iter()
            .filter_map(|name| ends("tables", name, &["exr", "ktx2", "dds", "png"]));
        if let Some(fault) = maps.or_else(|| tables.next()) {
            return Err(fault);
        }
        Texel::parse(self.texel).map_err(|fault| format!("texel: {fault}"))?;
        if code(self.language, "split-sum-two").is_none() {
            let fault = not_one_of(
                "shading language",
                self.language,
                &["GLSL", "HLSL", "WGSL"],
                "",
            );
            return Err(format!("language: {fault}"));
        }
        match (self.last_side, self.level_count) {
            (side @ 1..=1024, None | Some(2..=16)) if side.is_power_of_two() => Ok(()),
            _ => Err(
                "last_side, level_count: expected a power of 2 from 1 to 1024 and 2 to 16 levels"
                    .to_owned(),
            ),
        }
    }

    pub fn levels(&self, side: u32) -> u32 {
        self.level_count
            .unwrap_or_else(|| (side / self.last_side).max(2).ilog2() + 1)
    }
}
