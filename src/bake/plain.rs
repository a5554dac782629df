//! Bakes tables for any program: the prefiltered map, DFG table and taps of each model, SH9, the
//! irradiance map.

use super::container::{TEXELS_MAX, write_table};
use super::convention::{Axes, TABLE_AXES};
use super::judge::{Directions, exact};
use super::make::{dfg, write_bytes};
use super::parts::Stated;
use super::paste;
use super::source::MANIFEST;
use crate::base::files::{RECORD_BYTES_MAX, names_in, read_text};
use crate::base::math::harmonics::Harmonics;
use crate::base::names::Listed;
use crate::base::pixels::{Content, Fault, Pixels, PixelsError, exr};
use crate::instrument::brdf::{Brdf, MaskingShadowing};
use crate::instrument::environment::Environment;
use crate::instrument::environment::layout::MapLayout;
use crate::instrument::precompute::prefilter::{Kernel, LevelSpacing, harmonic};
use crate::instrument::precompute::sh9::reference::project_bilinear;
use crate::instrument::precompute::taps::TapCount;
use crate::instrument::precompute::{PrecomputeSettings, exact_quadrature};
use serde_json::json;
use std::path::{Path, PathBuf};

/// The axes of an experiment that change a bake. The DFG table and the irradiance map are
/// integrals: they have no samples.
pub const SETTINGS: &[&str] = &[
    "brdf",
    "masking",
    "layout",
    "prefilter_size",
    "prefilter_level_count",
    "level_mapping",
    "prefilter_weight",
    "dfg_size",
    "irradiance_size",
];

/// What to bake.
#[derive(Clone, Copy, Debug)]
pub struct Baking<'a> {
    pub environment: &'a Environment,
    pub settings: PrecomputeSettings,
    /// Each gets a prefiltered map, a DFG table and tables of taps.
    pub brdfs: &'a [&'static dyn Brdf],
    pub masking: MaskingShadowing,
}

impl Baking<'_> {
    /// Reports settings that no bake can have.
    pub fn check(&self) -> Result<(), String> {
        let PrecomputeSettings {
            layout,
            prefilter_size: [width, height],
            ..
        } = self.settings;
        self.settings
            .validate()
            .map_err(|error| format!("--set: {error}"))?;
        if !exr::IS_BUILT {
            return Err("bake writes OpenEXR; build with the feature exr".to_owned());
        }
        if u64::from(layout.face_count) * u64::from(width) * u64::from(height) > TEXELS_MAX {
            let name = layout.name;
            return Err(format!(
                "--set: prefilter_size is {width}x{height}; expected at most {TEXELS_MAX} texels \
                 by layout {name}"
            ));
        }
        Ok(())
    }

    /// Writes the files into the folder `out`, `bake.json` last, and returns their paths. Removes
    /// the levels of an earlier bake, which may have more of them.
    pub fn bake(&self, out: &Path) -> Result<Vec<PathBuf>, PixelsError> {
        std::fs::create_dir_all(out).map_err(|error| {
            Fault::new(format!("cannot be created ({error})"), "a folder").in_file(out)
        })?;
        self.remove_earlier(out)?;
        let settings = &self.settings;
        let levels = settings.prefilter_level_count;
        let degree = harmonic::degree_of_map(settings.level_mapping.narrowest_alpha(levels));
        let harmonics = harmonic::harmonics(&self.environment.image, degree);
        let mut files = Files {
            out,
            paths: Vec::new(),
        };
        files.json("sh9.json", &sh9(self.environment))?;
        let cosine = harmonic::cosine_factors(degree);
        let size = settings.irradiance_size;
        let irradiance = harmonic::texels(&harmonics, &cosine, settings.layout, size);
        files.image(
            "irradiance_over_pi.exr",
            Content::Radiance,
            &faces(settings.layout, size, irradiance),
        )?;
        for brdf in self.brdfs {
            self.bake_levels(*brdf, &harmonics, &mut files)?;
            self.bake_tables(*brdf, &mut files)?;
        }
        let manifest = self.manifest(&files.names());
        files.json(MANIFEST, &manifest)?;
        Ok(files.paths)
    }

    /// Removes manifest and levels of an earlier bake; refuses a bake for an engine.
    fn remove_earlier(&self, out: &Path) -> Result<(), PixelsError> {
        let manifest = read_text(&out.join(MANIFEST), RECORD_BYTES_MAX).unwrap_or_default();
        if serde_json::from_str::<Stated>(&manifest).is_ok_and(|stated| stated.preset.is_some()) {
            return Err(
                Fault::new("has the files of `bake --for`", "a new or an empty folder")
                    .in_file(out),
            );
        }
        let prefixes: Vec<String> = self
            .brdfs
            .iter()
            .map(|brdf| format!("prefiltered_{}_", brdf.name()))
            .collect();
        for name in names_in(out) {
            let is_level = prefixes.iter().any(|prefix| name.starts_with(prefix));
            if name == MANIFEST || is_level {
                let path = out.join(name);
                std::fs::remove_file(&path).map_err(|error| {
                    Fault::new(format!("cannot be replaced ({error})"), "a file").in_file(&path)
                })?;
            }
        }
        Ok(())
    }

    fn alpha(&self, level: u32) -> f64 {
        let PrecomputeSettings {
            level_mapping,
            prefilter_level_count,
            ..
        } = self.settings;
        level_mapping.alpha_from_mip(level.into(), prefilter_level_count)
    }

    fn kernel(&self, brdf: &'static dyn Brdf) -> Kernel {
        Kernel::new(brdf, self.settings.prefilter_weight, self.masking)
    }

    /// Writes the levels of a model's prefiltered map.
    fn bake_levels(
        &self,
        brdf: &'static dyn Brdf,
        harmonics: &Harmonics,
        files: &mut Files,
    ) -> Result<(), PixelsError> {
        let layout = self.settings.layout;
        for level in 0..self.settings.prefilter_level_count {
            let alpha = self.alpha(level);
            let size = self.settings.prefilter_size.map(|side| side >> level);
            let texels = if alpha == 0.0 {
                // Texels of a mirror are means of the environment.
                let directions = Directions::new(layout, Axes::SAME, size);
                exact::mirror(self.environment, &directions)
                    .into_iter()
                    .map(|texel| texel.as_vec3().extend(1.0).to_array())
                    .collect()
            } else {
                harmonic::level(harmonics, self.kernel(brdf), alpha, layout, size)
            };
            files.image(
                &format!("prefiltered_{}_{level}.exr", brdf.name()),
                Content::Radiance,
                &faces(layout, size, texels),
            )?;
        }
        Ok(())
    }

    /// Writes a model's DFG table and tables of taps.
    fn bake_tables(&self, brdf: &'static dyn Brdf, files: &mut Files) -> Result<(), PixelsError> {
        let name = brdf.name();
        let table = dfg(brdf, self.masking, &TABLE_AXES[0], self.settings.dfg_size)
            .map(|[a, b, _]| [a, b, 0.0, 0.0]);
        // Viewers show nothing for channels named A and B, and ffmpeg refuses two channels.
        files.image(&format!("dfg_{name}.exr"), Content::Data, &table)?;
        for count in TapCount::ALL {
            let word = count.word();
            let taps = paste::taps(
                self.kernel(brdf),
                self.masking,
                LevelSpacing {
                    mapping: self.settings.level_mapping,
                    level_count: self.settings.prefilter_level_count,
                },
                count,
            );
            files.channels(
                &format!("taps_{word}_{name}.exr"),
                Content::Data,
                &taps,
                &["R", "G", "B", "A"],
            )?;
            files.bytes(&format!("taps_{word}_{name}.ktx2"), &write_table(&taps))?;
        }
        Ok(())
    }

    fn manifest(&self, names: &[&str]) -> serde_json::Value {
        let settings = &self.settings;
        let alphas: Vec<f64> = (0..settings.prefilter_level_count)
            .map(|level| self.alpha(level))
            .collect();
        json!({
            "version": format!("splitsum {}", env!("CARGO_PKG_VERSION")),
            "environment": self.environment.file_name(),
            "environment_hash": self.environment.hash,
            "masking_shadowing": self.masking.name(),
            "layout": settings.layout.name,
            "mapping": settings.layout.mapping,
            "radiance": "linear Rec.709",
            "dfg": "channel R (A of the text) scales f0, channel G (B) is added; x = n_dot_v, y = \
                    perceptual_roughness, both at texel centres (i + 0.5) / size, row 0 is the \
                    smoothest; a lookup within half a texel of an edge is clamped: at roughness 1 \
                    ggx errs by up to 0.5 / size",
            "taps": "square parts below each other, nodes at both ends of x = sqrt(n_dot_v) and y \
                     = perceptual_roughness: for F0 1, then for 0.04, a part for each two taps \
                     (place between n and r, level, twice) and a part of weights, which one tap \
                     lacks; for this number and mapping of levels; docs/paste.md",
            "irradiance": "irradiance / pi: what a Lambert surface of albedo 1 reflects",
            "prefilter_alphas": alphas,
            "level_mapping": settings.level_mapping.name,
            "prefilter_weight": settings.prefilter_weight.name,
            "files": names,
        })
    }
}

/// The files of a bake in a folder.
struct Files<'a> {
    out: &'a Path,
    paths: Vec<PathBuf>,
}

impl Files<'_> {
    fn names(&self) -> Vec<&str> {
        self.paths
            .iter()
            .filter_map(|path| path.file_name()?.to_str())
            .collect()
    }

    fn bytes(&mut self, name: &str, bytes: &[u8]) -> Result<(), PixelsError> {
        let path = self.out.join(name);
        write_bytes(&path, bytes)?;
        self.paths.push(path);
        Ok(())
    }

    fn json(&mut self, name: &str, value: &serde_json::Value) -> Result<(), PixelsError> {
        self.bytes(name, format!("{value:#}\n").as_bytes())
    }

    /// Writes red, green and blue of an image.
    fn image(
        &mut self,
        name: &str,
        content: Content,
        texels: &Pixels<[f32; 4]>,
    ) -> Result<(), PixelsError> {
        self.channels(name, content, texels, &["R", "G", "B"])
    }

    /// Writes the first channels of an image by these names.
    fn channels(
        &mut self,
        name: &str,
        content: Content,
        texels: &Pixels<[f32; 4]>,
        channels: &[&str],
    ) -> Result<(), PixelsError> {
        let path = self.out.join(name);
        let channels = channels
            .iter()
            .enumerate()
            .map(|(i, name)| ((*name).to_owned(), texels.map(|texel| texel[i])));
        exr::write_channels(&path, content, channels.collect())?;
        self.paths.push(path);
        Ok(())
    }
}

/// Puts the faces of a level below each other.
fn faces(layout: &MapLayout, [width, height]: [u32; 2], texels: Vec<[f32; 4]>) -> Pixels<[f32; 4]> {
    Pixels::new(width, height * layout.face_count, texels)
}

fn sh9(environment: &Environment) -> serde_json::Value {
    let radiance = project_bilinear(&exact_quadrature(&environment.image));
    json!({
        "environment": environment.file_name(),
        "environment_hash": environment.hash,
        "basis": "real spherical harmonics of the world direction (y up), no Condon-Shortley sign",
        "order": [
            "Y00",
            "Y1-1 (y)",
            "Y10 (z)",
            "Y11 (x)",
            "Y2-2 (xy)",
            "Y2-1 (yz)",
            "Y20 (3z^2-1)",
            "Y21 (xz)",
            "Y22 (x^2-y^2)",
        ],
        "meaning": "radiance L_lm = integral of L Y_lm; irradiance(n) = sum of A_l L_lm Y_lm(n) \
                    with A = pi, 2pi/3, pi/4",
        "radiance": radiance.map(|coefficient| coefficient.as_vec3().to_array()),
    })
}
