//! Writes the files of a bake for an engine.

use super::exact_maps::{ExactMap, ExactMaps};
use super::making::Making;
use crate::bake::babylon_env;
use crate::bake::container::{BYTES_KEY, ByteColor, Encoding, Texel, write_table};
use crate::bake::convention::Convention;
use crate::bake::face_folder::FACES;
use crate::bake::map_form::{MapForm, container};
use crate::bake::parts::{KEY, Manifest};
use crate::bake::paste::{self, TAPS};
use crate::bake::playcanvas_atlas;
use crate::bake::sh;
use crate::bake::source::MANIFEST;
use crate::bake::{f3d_cache, f3d_sh};
use crate::base::names::Listed;
use crate::base::numbers::short_number;
use crate::base::pixels::{
    Content, Fault, GrayImage, PixelsError, Rgb8Image, RgbImage, exr, png, write_atomically,
};
use crate::instrument::precompute::prefilter::Kernel;
use crate::instrument::precompute::sh9::reference::Sh9;
use crate::instrument::precompute::taps::TapCount;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The files of a bake in a folder.
pub struct Writer<'a> {
    making: &'a Making<'a>,
    out: &'a Path,
    kernel: Kernel,
    manifest: Manifest,
    /// Metadata of containers without SH.
    keys: Vec<(String, String)>,
    pub files: Vec<PathBuf>,
}

impl<'a> Writer<'a> {
    pub fn new(
        making: &'a Making<'a>,
        convention: &Convention,
        exact: &ExactMaps,
        out: &'a Path,
    ) -> Self {
        let manifest = manifest(making, convention, &exact.alphas);
        Self {
            making,
            out,
            kernel: exact.kernel,
            keys: keys(&manifest, ByteColor::of_texel(making.texel)),
            manifest,
            files: Vec::new(),
        }
    }

    /// Writes a file.
    pub fn bytes(&mut self, name: &str, bytes: &[u8]) -> Result<(), PixelsError> {
        let path = self.out.join(name);
        write_bytes(&path, bytes)?;
        self.files.push(path);
        Ok(())
    }

    /// Writes the prefiltered map and the irradiance map.
    pub fn maps(&mut self, exact: &ExactMaps, convention: &Convention) -> Result<(), PixelsError> {
        let name = self.making.preset.product().specular;
        match self.making.form() {
            MapForm::BabylonEnv => {
                let file = babylon_env::write(&exact.specular.faces, &exact.radiance);
                return self.bytes(name, &file);
            }
            MapForm::PlayCanvasAtlas => {
                let images = |map: &ExactMap| map.faces.iter().flatten().cloned().collect();
                let file = playcanvas_atlas::write(
                    self.making.side,
                    &playcanvas_atlas::Images {
                        levels: images(&exact.specular),
                        mips: exact.mips(self.making, convention),
                        irradiance: exact.irradiance.as_ref().map_or_else(Vec::new, images),
                    },
                );
                return self.bytes(name, &file);
            }
            MapForm::F3dCache => return self.f3d_cache(name, &exact.specular.faces),
            MapForm::Faces | MapForm::Container(_) => {}
        }
        // SH comes last: Filament's reader searches for that key.
        let mut keys = self.keys.clone();
        keys.push(("sh".to_owned(), sh_lines(&exact.radiance)));
        exact.maps().try_for_each(|map| self.map(map, &keys))?;
        if let Some(name) = self.making.preset.product().skybox {
            let keys = self.keys_of_mirror();
            self.container(name, &exact.specular.faces[..1], &keys)?;
        }
        Ok(())
    }

    /// Returns the metadata of a file with level 0 alone.
    fn keys_of_mirror(&self) -> Vec<(String, String)> {
        let alphas = format!("{KEY}alphas");
        let mut keys = self.keys.clone();
        for (key, value) in &mut keys {
            if *key == alphas {
                *value = "0".to_owned();
            }
        }
        keys
    }

    /// Writes the list of levels, then their images.
    fn f3d_cache(&mut self, name: &str, levels: &[Vec<RgbImage>]) -> Result<(), PixelsError> {
        let folder = self.out.join(f3d_cache::folder_of(name));
        std::fs::create_dir_all(&folder).map_err(|error| {
            Fault::new(format!("cannot be created ({error})"), "a folder of levels")
                .in_file(&folder)
        })?;
        self.bytes(name, f3d_cache::list(name, levels.len()).as_bytes())?;
        for (k, faces) in levels.iter().enumerate() {
            self.bytes(&f3d_cache::level_name(name, k), &f3d_cache::cube(faces))?;
        }
        Ok(())
    }

    fn map(&mut self, map: &ExactMap, keys: &[(String, String)]) -> Result<(), PixelsError> {
        if container(map.name).is_none() {
            return self.faces(map);
        }
        self.container(map.name, &map.faces, keys)
    }

    /// Writes levels to a file whose extension names its container.
    fn container(
        &mut self,
        name: &str,
        levels: &[Vec<RgbImage>],
        keys: &[(String, String)],
    ) -> Result<(), PixelsError> {
        let format = container(name).expect("checked where the preset was read");
        let encoding = Encoding {
            texel: self.making.texel,
            levels,
            keys,
            is_packed: self.making.preset.product().is_packed,
        };
        self.bytes(name, &(format.write)(&encoding))
    }

    /// Writes a folder with a file for each face.
    fn faces(&mut self, map: &ExactMap) -> Result<(), PixelsError> {
        let folder = self.out.join(map.name);
        std::fs::create_dir_all(&folder).map_err(|error| {
            Fault::new(format!("cannot be created ({error})"), "a folder of faces").in_file(&folder)
        })?;
        for (k, faces) in map.faces.iter().enumerate() {
            for (face, name) in faces.iter().zip(FACES) {
                let path = folder.join(format!("m{k}_{name}.exr"));
                let alpha = GrayImage::filled(face.width, face.height, 1.0);
                exr::write_rgba(&path, face, &alpha, &[])?;
                self.files.push(path);
            }
        }
        Ok(())
    }

    /// Writes a table in each format of the engine.
    pub fn tables(&mut self, table: &RgbImage) -> Result<(), PixelsError> {
        for name in &self.making.preset.product().tables {
            let path = self.out.join(name);
            self.table(table, name, &path)?;
            self.files.push(path);
        }
        Ok(())
    }

    fn table(&self, table: &RgbImage, name: &str, path: &Path) -> Result<(), PixelsError> {
        if let Some(format) = container(name) {
            let encoding = Encoding {
                texel: Texel::listed("rg16f"),
                levels: &[vec![table.clone()]],
                keys: &self.keys,
                is_packed: false,
            };
            return write_bytes(path, &(format.write)(&encoding));
        }
        if name.ends_with(".png") {
            let byte = |value: f32| (255.0 * value.clamp(0.0, 1.0)).round() as u8;
            let bytes = |x, y| table.get(x, y).map(byte);
            return png::write_rgb8(path, &Rgb8Image::from_fn(table.width, table.height, bytes));
        }
        // Viewers show nothing under the names A and B, and ffmpeg refuses two channels.
        let channel = |i: usize| table.map(|texel| texel[i]);
        let empty = GrayImage::filled(table.width, table.height, 0.0);
        let channels = vec![
            ("R".into(), channel(0)),
            ("G".into(), channel(1)),
            ("B".into(), empty),
        ];
        exr::write_channels(path, Content::Data, channels)
    }

    /// Writes SH as F3D's table or as cmgen's text, if the engine reads it.
    pub fn sh(&mut self, exact: &ExactMaps) -> Result<(), PixelsError> {
        let Some(name) = self.making.preset.product().sh else {
            return Ok(());
        };
        let text = match self.making.form() {
            MapForm::F3dCache => f3d_sh::text(&exact.radiance),
            _ => sh::to_cmgen(&exact.radiance),
        };
        self.bytes(name, text.as_bytes())
    }

    /// Writes the table of two taps and the code that reads it, if the map's levels are for them.
    pub fn taps(
        &mut self,
        convention: &Convention,
        code_name: &str,
        code: &str,
    ) -> Result<(), PixelsError> {
        if !self.making.form().has_taps() {
            return Ok(());
        }
        let spacing = convention
            .spacing(self.making.level_count as usize)
            .expect("checked where the preset was read");
        let taps = paste::taps(self.kernel, self.making.masking, spacing, TapCount::Two);
        self.bytes(TAPS, &write_table(&taps))?;
        self.bytes(code_name, code.as_bytes())
    }

    /// Writes `bake.json`.
    pub fn manifest(&mut self) -> Result<(), PixelsError> {
        let text = serde_json::to_string_pretty(&self.manifest).expect("plain values") + "\n";
        self.bytes(MANIFEST, text.as_bytes())
    }
}

/// Writes a file, complete or not at all.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), PixelsError> {
    write_atomically(path, |file| file.write_all(bytes))
}

fn manifest(making: &Making, convention: &Convention, alphas: &[f64]) -> Manifest {
    let product = making.preset.product();
    let owned = |name: &str| name.to_owned();
    Manifest {
        version: format!("splitsum {}", env!("CARGO_PKG_VERSION")),
        engine: owned(product.engine),
        preset: owned(making.preset.name),
        environment: making.environment.file_name().to_owned(),
        environment_hash: making.environment.hash.clone(),
        brdf: owned(making.brdf.name()),
        masking_shadowing: owned(making.masking.name()),
        prefilter_weight: owned(making.weight.name),
        prefilter_alphas: alphas.to_vec(),
        level_mapping: mapping_words(convention),
        axes: convention.axes.to_string(),
        table_axes: owned(convention.table_axes.name),
        units: owned("linear Rec.709, radiance as the environment has it; irradiance over pi"),
        pixel_format: owned(making.texel.name),
        specular: owned(product.specular),
        skybox: product.skybox.map(owned),
        irradiance: product.irradiance.map(owned),
        tables: product.tables.iter().map(|name| owned(name)).collect(),
        sh: product.sh.map(owned),
        taps: making.form().has_taps().then(|| owned(TAPS)),
    }
}

/// The name of the mapping, or the listed roughness of each level: "0.08:0.185:0.29".
fn mapping_words(convention: &Convention) -> String {
    match &convention.alphas {
        None => convention.mapping.name.to_owned(),
        Some(alphas) => {
            let words = alphas
                .iter()
                .map(|alpha| short_number(&alpha.sqrt().to_string()).to_string());
            words.collect::<Vec<_>>().join(":")
        }
    }
}

/// Builds a container's metadata without SH; `byte_color` says what its texels of bytes hold.
fn keys(manifest: &Manifest, byte_color: Option<ByteColor>) -> Vec<(String, String)> {
    let alphas: Vec<String> = manifest
        .prefilter_alphas
        .iter()
        .map(|alpha| format!("{alpha:.6}"))
        .collect();
    let common = [("KTXorientation", "rd"), ("KTXwriter", &manifest.version)]
        .map(|(key, value)| (key.to_owned(), value.to_owned()));
    let ours = [
        ("preset", &manifest.preset),
        ("source", &manifest.environment),
        ("source_hash", &manifest.environment_hash),
        ("brdf", &manifest.brdf),
        ("masking", &manifest.masking_shadowing),
        ("weight", &manifest.prefilter_weight),
        ("mapping", &manifest.level_mapping),
        ("alphas", &alphas.join(",")),
        ("axes", &manifest.axes),
        ("table_axes", &manifest.table_axes),
        ("units", &manifest.units),
    ]
    .map(|(key, value)| (format!("{KEY}{key}"), value.clone()));
    let bytes = byte_color.map(|color| (format!("{KEY}{BYTES_KEY}"), color.name().to_owned()));
    common.into_iter().chain(ours).chain(bytes).collect()
}

/// Writes cmgen's coefficients, a line each.
fn sh_lines(radiance: &Sh9) -> String {
    sh::scaled(radiance)
        .iter()
        .map(|[r, g, b]| format!("{r} {g} {b}\n"))
        .collect()
}
