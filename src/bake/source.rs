//! Finds the parts of a bake in files and folders.
//!
//! A cube or lat-long map is prefiltered radiance, or irradiance if it has one level; a square
//! image is a DFG table; text is SH. `irradiance=FILE` and so on override this.

use super::container::{ByteColor, FACE_COUNT, FORMATS, Texture, read_texture_of};
use super::face_folder;
use super::packed::{self, Packed};
use super::parts::{Bake, Manifest, Map};
use super::{f3d_cache, f3d_sh, sh};
use crate::base::files::{RECORD_BYTES_MAX, inside, names_in, read_text};
use crate::base::names::Listed;
use crate::base::pixels::{Fault, Pixels, PixelsError, RgbImage};
use crate::instrument::brdf::MODELS;
use crate::instrument::environment::layout::{LAYOUTS, MapLayout};
use std::path::{Path, PathBuf};

/// A part of a bake in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    Specular,
    Irradiance,
    Dfg,
    Sh,
}

/// Prefixes of a file argument.
pub const PARTS: &[(&str, Part)] = &[
    ("specular", Part::Specular),
    ("irradiance", Part::Irradiance),
    ("dfg", Part::Dfg),
    ("sh", Part::Sh),
];

/// How to read ambiguous files.
#[derive(Clone, Copy, Debug)]
pub struct Reading<'a> {
    /// Layout of images that are neither a cube nor a table.
    pub layout: Option<&'static MapLayout>,
    /// Model whose tables to read from a folder of several.
    pub brdf: &'a str,
    /// What texels of four bytes hold; `None` refuses them, unless the file says it.
    pub byte_color: Option<ByteColor>,
}

impl Default for Reading<'_> {
    /// Reads tables of GGX and lat-long images.
    fn default() -> Self {
        Self {
            layout: None,
            brdf: MODELS[0].name(),
            byte_color: None,
        }
    }
}

/// Reads a bake from `FILE`, `FOLDER` or `PART=FILE`. Images of one level each form a chain in the
/// given order.
pub fn read(files: &[String], reading: Reading) -> Result<Bake, PixelsError> {
    let mut bake = Bake::default();
    for file in files {
        let (part, path) = part_and_path(file)?;
        if path.is_dir() {
            read_folder(&path, part, reading, &mut bake)?;
            continue;
        }
        add_file(&mut bake, &path, part, reading)?;
    }
    Ok(bake)
}

fn part_and_path(file: &str) -> Result<(Option<Part>, PathBuf), PixelsError> {
    let Some((name, path)) = file.split_once('=').filter(|_| !Path::new(file).exists()) else {
        return Ok((None, file.into()));
    };
    match PARTS.iter().find(|(known, _)| *known == name) {
        Some((_, part)) => Ok((Some(*part), path.into())),
        None if Path::new(path).exists() => {
            let known: Vec<String> = PARTS
                .iter()
                .map(|(name, _)| format!("{name}=FILE"))
                .collect();
            Err(
                Fault::new("is neither a file nor a part of a bake", known.join(", "))
                    .in_file(Path::new(file)),
            )
        }
        None => Ok((None, file.into())),
    }
}

/// Sets a part; refuses a second one.
fn once<T>(part: &mut Option<T>, value: T, what: &str, path: &Path) -> Result<(), PixelsError> {
    match part.replace(value) {
        None => Ok(()),
        Some(_) => Err(Fault::new(
            format!("is the second {what} of this bake"),
            "one; check them separately",
        )
        .in_file(path)),
    }
}

fn add_sh(bake: &mut Bake, path: &Path) -> Result<(), PixelsError> {
    let mut warnings = Vec::new();
    let found = sh::read(path, &mut warnings)?;
    bake.warn(path, warnings);
    once(&mut bake.sh, found, "SH", path)
}

fn add_file(
    bake: &mut Bake,
    path: &Path,
    part: Option<Part>,
    reading: Reading,
) -> Result<(), PixelsError> {
    let extension = path
        .extension()
        .map(|extension| extension.to_string_lossy().to_lowercase());
    let is_text = matches!(
        extension.as_deref(),
        Some("txt" | "json" | f3d_sh::EXTENSION)
    );
    if part == Some(Part::Sh) || (part.is_none() && is_text) {
        return add_sh(bake, path);
    }
    let is_map = part == Some(Part::Specular);
    if let Some(found) = packed::read(path, part.is_none() || is_map, is_map)? {
        return add_packed(bake, found, path);
    }
    let Texture {
        levels,
        keys,
        warnings,
        ..
    } = read_texture_of(path, reading.byte_color)?;
    bake.stated.add(&keys);
    bake.warn(path, warnings);
    let first = &levels[0][0];
    let is_square_image = levels[0].len() == 1 && first.width == first.height;
    let is_table = part.is_none() && is_square_image && reading.layout.is_none();
    if part == Some(Part::Dfg) || is_table {
        let table = table(levels).map_err(|fault| fault.in_file(path))?;
        return once(&mut bake.dfg, table, "DFG table", path);
    }
    let is_cube = levels[0].len() == FACE_COUNT;
    let map = map(levels, reading.layout).map_err(|fault| fault.in_file(path))?;
    // A single level in a cube or container is irradiance.
    let is_irradiance = match part {
        Some(part) => part == Part::Irradiance,
        None => is_cube && map.levels.len() == 1,
    };
    if is_irradiance {
        return once(&mut bake.irradiance, map, "irradiance map", path);
    }
    add_levels(&mut bake.specular, map, path)
}

fn add_packed(bake: &mut Bake, found: Packed, path: &Path) -> Result<(), PixelsError> {
    once(&mut bake.specular, found.specular, "prefiltered map", path)?;
    if let Some(irradiance) = found.irradiance {
        once(&mut bake.irradiance, irradiance, "irradiance map", path)?;
    }
    if let Some(sh) = found.sh {
        once(&mut bake.sh, sh, "SH", path)?;
    }
    bake.has_rounded_up_scale |= found.has_rounded_up_scale;
    bake.stated.state(found.preset, found.alphas);
    Ok(())
}

/// Returns the image of a DFG table.
fn table(mut levels: Vec<Vec<RgbImage>>) -> Result<RgbImage, Fault> {
    if levels[0].len() != 1 {
        return Err(Fault::new("is a cube", "one image for a DFG table"));
    }
    let image = levels.swap_remove(0).swap_remove(0);
    let RgbImage { width, height, .. } = image;
    if width != height {
        return Err(Fault::new(
            format!("it is {width}x{height}"),
            "a square DFG table",
        ));
    }
    Ok(image)
}

/// Splits levels of one image each into faces; `layout` is for images that are not a cube.
fn map(mut levels: Vec<Vec<RgbImage>>, layout: Option<&'static MapLayout>) -> Result<Map, Fault> {
    let face_count = levels[0].len();
    let RgbImage { width, height, .. } = levels[0][0];
    let layout = match layout {
        _ if face_count == FACE_COUNT => cube(),
        Some(layout) => layout,
        None if width == 2 * height => MapLayout::listed("equirect"),
        None if height == FACE_COUNT as u32 * width => cube(),
        None => {
            return Err(Fault::new(
                format!("it is one image of {width}x{height}"),
                "a lat-long map (2:1), a cube as six faces below each other (1:6) or a square DFG \
                 table; --layout selects another",
            ));
        }
    };
    if face_count == 1 {
        levels = levels
            .into_iter()
            .map(|mut level| split(level.swap_remove(0), layout))
            .collect::<Result<_, _>>()?;
    }
    Ok(Map { layout, levels })
}

/// Sets the prefiltered map, or adds a level to its chain.
fn add_levels(specular: &mut Option<Map>, map: Map, path: &Path) -> Result<(), PixelsError> {
    match specular {
        Some(chain) if chain.layout == map.layout && map.levels.len() == 1 => {
            let before = chain.levels[chain.levels.len() - 1][0].width;
            let width = map.levels[0][0].width;
            if width > before {
                return Err(Fault::new(
                    format!("its level is {width} wide, the one before {before}"),
                    "levels from the smoothest, the widest, on",
                )
                .in_file(path));
            }
            chain.levels.extend(map.levels);
            Ok(())
        }
        _ => once(specular, map, "prefiltered map", path),
    }
}

fn cube() -> &'static MapLayout {
    &LAYOUTS[0]
}

/// Splits an image of faces below each other.
fn split(image: RgbImage, layout: &'static MapLayout) -> Result<Vec<RgbImage>, Fault> {
    let Pixels {
        width,
        height,
        data,
    } = image;
    let side = height / layout.face_count;
    if side == 0 || height % layout.face_count != 0 || (layout.is_square && side != width) {
        return Err(Fault::new(
            format!("it is one image of {width}x{height}"),
            format!("the layout {}: {}", layout.name, layout.mapping),
        ));
    }
    let faces = data.chunks_exact(width as usize * side as usize);
    Ok(faces
        .map(|face| Pixels::new(width, side, face.to_vec()))
        .collect())
}

fn read_folder(
    path: &Path,
    part: Option<Part>,
    reading: Reading,
    bake: &mut Bake,
) -> Result<(), PixelsError> {
    let names = names_in(path);
    if let Some((name, _)) = PARTS
        .iter()
        .find(|(_, known)| part == Some(*known) && matches!(known, Part::Dfg | Part::Sh))
    {
        return Err(Fault::new("is a folder", format!("a file for {name}=")).in_file(path));
    }
    if names.iter().any(|name| name == MANIFEST) {
        return read_ours(path, &names, reading, bake);
    }
    // The files of a tool such as cmgen; its skybox is the map itself.
    let is_part = |name: &&String| {
        let mut extensions = FORMATS
            .iter()
            .map(|format| format.extension)
            .chain([f3d_cache::EXTENSION, f3d_sh::EXTENSION]);
        let is_texture = extensions.any(|extension| name.ends_with(&format!(".{extension}")));
        (is_texture || name.ends_with("sh.txt")) && !name.contains("skybox")
    };
    let parts: Vec<&String> = names.iter().filter(is_part).collect();
    if part.is_none()
        && parts
            .iter()
            .any(|name| !name.ends_with("sh.txt") && face_folder::face_of(name).is_none())
    {
        return parts
            .into_iter()
            .try_for_each(|name| add_file(bake, &path.join(name), None, reading));
    }
    add_faces(bake, path, part)?;
    if names.iter().any(|name| name == "sh.txt") {
        add_sh(bake, &path.join("sh.txt"))?;
    }
    Ok(())
}

fn add_faces(bake: &mut Bake, path: &Path, part: Option<Part>) -> Result<(), PixelsError> {
    let map = face_folder::read(path, &names_in(path))?;
    let is_irradiance = part.map_or(map.levels.len() == 1, |part| part == Part::Irradiance);
    if is_irradiance {
        once(&mut bake.irradiance, map, "irradiance map", path)
    } else {
        once(&mut bake.specular, map, "prefiltered map", path)
    }
}

/// File with the conventions of a bake.
pub const MANIFEST: &str = "bake.json";

fn read_ours(
    path: &Path,
    names: &[String],
    reading: Reading,
    bake: &mut Bake,
) -> Result<(), PixelsError> {
    #[derive(serde::Deserialize)]
    struct File {
        layout: String,
        prefilter_alphas: Vec<f64>,
    }
    let manifest = path.join(MANIFEST);
    let refuse =
        |what: String| Fault::new(what, "the bake.json of splitsum bake").in_file(&manifest);
    let not_read = |error: serde_json::Error| refuse(format!("cannot be read ({error})"));
    let text = read_text(&manifest, RECORD_BYTES_MAX)
        .map_err(|error| refuse(format!("cannot be read ({error})")))?;
    bake.stated = serde_json::from_str(&text).map_err(not_read)?;
    if bake.stated.preset.is_some() {
        return read_engines(
            path,
            serde_json::from_str(&text).map_err(not_read)?,
            reading,
            bake,
        );
    }
    let file: File = serde_json::from_str(&text).map_err(not_read)?;
    let layout = MapLayout::by_name(&file.layout)
        .ok_or_else(|| refuse(format!("its layout is {:?}", file.layout)))?;
    if file.prefilter_alphas.is_empty() {
        return Err(refuse("it lists no level".to_owned()));
    }
    let brdf = reading.brdf;
    let reading = Reading {
        layout: Some(layout),
        ..reading
    };
    let levels = (0..file.prefilter_alphas.len())
        .map(|k| (format!("prefiltered_{brdf}_{k}.exr"), Part::Specular));
    let others = [
        (format!("dfg_{brdf}.exr"), Part::Dfg),
        ("sh9.json".to_owned(), Part::Sh),
        ("irradiance_over_pi.exr".to_owned(), Part::Irradiance),
    ];
    for (name, part) in levels.chain(others.into_iter().filter(|(name, _)| names.contains(name))) {
        add_file(bake, &path.join(name), Some(part), reading)?;
    }
    Ok(())
}

fn read_engines(
    path: &Path,
    file: Manifest,
    reading: Reading,
    bake: &mut Bake,
) -> Result<(), PixelsError> {
    if file.brdf != reading.brdf {
        let what = format!("its model is {}", file.brdf);
        return Err(
            Fault::new(what, format!("{}; --brdf selects another", reading.brdf))
                .in_file(&path.join(MANIFEST)),
        );
    }
    let maps = [
        (Some(&file.specular), Part::Specular),
        (file.irradiance.as_ref(), Part::Irradiance),
    ];
    let maps = maps
        .into_iter()
        .filter_map(|(name, part)| Some((name?, part)));
    let named = |name: &str| {
        inside(path, name).map_err(|what| {
            Fault::new(what, "files beside bake.json").in_file(&path.join(MANIFEST))
        })
    };
    // One table format is enough.
    let table = file.tables.first().map(|name| (name, Part::Dfg));
    for (name, part) in maps
        .chain(table)
        .chain(file.sh.as_ref().map(|name| (name, Part::Sh)))
    {
        let path = named(name)?;
        if path.is_dir() {
            add_faces(bake, &path, Some(part))?;
        } else {
            add_file(bake, &path, Some(part), reading)?;
        }
    }
    Ok(())
}
