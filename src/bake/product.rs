//! Output for each engine as data ([`super::convention::PRESETS`]).

use super::container::{SRGB8, Texel};
use super::map_form::{MapForm, container};
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
    /// Level 0 alone in another file, for the background.
    #[serde(borrow = "'static")]
    pub skybox: Option<&'static str>,
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
    /// Pixel formats that the container holds but the engine does not draw.
    #[serde(borrow = "'static")]
    pub excluded_texels: Vec<&'static str>,
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
            skybox: None,
            irradiance: None,
            tables: Vec::new(),
            language: "GLSL",
            sh: None,
            texel: "rgba16f",
            excluded_texels: Vec::new(),
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
        self.check_names()?;
        self.check_extensions()?;
        let is_ktx = |name| container(name).is_some_and(|format| !format.needs_dxgi);
        if self.texel != SRGB8.name {
            Texel::parse(self.texel).map_err(|fault| format!("texel: {fault}"))?;
        } else if !is_ktx(self.specular) {
            return Err(format!("texel: {} is for KTX files", SRGB8.name));
        }
        for name in &self.excluded_texels {
            Texel::parse(name).map_err(|fault| format!("excluded_texels: {fault}"))?;
        }
        if code(self.language, "split-sum-two").is_none() {
            let known = ["GLSL", "HLSL", "WGSL"];
            let fault = not_one_of("shading language", self.language, &known, "");
            return Err(format!("language: {fault}"));
        }
        let is_side = (1..=1024).contains(&self.last_side) && self.last_side.is_power_of_two();
        let is_level_count = self
            .level_count
            .is_none_or(|count| (2..=16).contains(&count));
        if !is_side || !is_level_count {
            return Err(
                "last_side, level_count: expected a power of 2 from 1 to 1024 and 2 to 16 levels"
                    .to_owned(),
            );
        }
        Ok(())
    }

    fn check_names(&self) -> Result<(), String> {
        let names = [
            Some(self.specular),
            self.skybox,
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
        for (index, name) in names.iter().enumerate() {
            let has_folder = Path::new(name)
                .file_name()
                .is_none_or(|file_name| file_name != *name);
            if has_folder || name.contains('\\') {
                return Err(format!("{name:?}: expected a file name without a folder"));
            }
            if names[..index].contains(name) {
                return Err(format!("{name:?}: two files have this name"));
            }
        }
        Ok(())
    }

    /// Maps without an extension are folders of faces.
    fn check_extensions(&self) -> Result<(), String> {
        let maps = [
            ("specular", Some(self.specular)),
            ("irradiance", self.irradiance),
        ];
        if let Some(name) = self.skybox {
            check_extension("skybox", name, &["ktx2", "ktx", "dds"])?;
        }
        for (key, name) in maps {
            if let Some(name) = name.filter(|name| name.contains('.')) {
                check_extension(key, name, &["ktx2", "ktx", "dds"])?;
            }
        }
        for name in &self.tables {
            check_extension("tables", name, &["exr", "ktx2", "dds", "png"])?;
        }
        Ok(())
    }

    /// Lists the pixel formats that the map may have. Bytes are for engines that read nothing else.
    pub fn texels(&self) -> Vec<&'static Texel> {
        if self.texel == SRGB8.name {
            return vec![&SRGB8];
        }
        let mut texels = MapForm::of(self.specular).texels();
        texels.retain(|texel| !self.excluded_texels.contains(&texel.name));
        texels
    }

    /// Returns the default pixel format.
    pub fn texel(&self) -> &'static Texel {
        let texels = self.texels();
        let named = texels.iter().find(|texel| texel.name == self.texel);
        named.copied().unwrap_or(texels[0])
    }

    /// Returns the number of levels of faces with this side.
    pub fn levels(&self, side: u32) -> u32 {
        self.level_count
            .unwrap_or_else(|| (side / self.last_side).max(2).ilog2() + 1)
    }
}

fn check_extension(key: &str, name: &str, known: &[&str]) -> Result<(), String> {
    let is_known = Path::new(name)
        .extension()
        .is_some_and(|extension| known.iter().any(|known| extension == *known));
    if is_known {
        Ok(())
    } else {
        Err(format!("{key}: {}", not_one_of("format", name, known, "")))
    }
}
