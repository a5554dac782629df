//! F3D's cache of a map: the prefiltered cube as a list of levels (`specular.vtm`) beside a folder
//! with an image each (`specular/specular_0.vti`); [`super::f3d_sh`] has the file beside it.
//!
//! F3D keeps it in a folder that has the MD5 of the map's file as its name, and reads it back in
//! place of its own filter [F3D 4.0.0, `vtkF3DCachedSpecularTexture`]. It reads five levels.

use super::parts::Map;
use super::vtk_xml;
use crate::base::files::inside;
use crate::base::pixels::{Fault, Pixels, PixelsError, RgbImage, read_bounded};
use crate::instrument::environment::layout::LAYOUTS;
use std::ffi::OsStr;
use std::fmt::Write;
use std::path::Path;

/// Extension of the list of levels.
pub const EXTENSION: &str = "vtm";
/// Name of the conventions in the list of presets.
pub const PRESET: &str = "vtk";

const FACES: usize = 6;
const CHANNELS: usize = 3;
const LEVELS_MAX: usize = 16;

/// Returns the folder of the images beside a list of this name.
pub fn folder_of(name: &str) -> &str {
    let stem = Path::new(name).file_stem().and_then(OsStr::to_str);
    stem.unwrap_or(name)
}

/// Returns the name of a level's image, relative to the list.
pub fn level_name(name: &str, level: usize) -> String {
    let folder = folder_of(name);
    format!("{folder}/{folder}_{level}.vti")
}

/// Reads the levels that a list names.
pub fn read(path: &Path) -> Result<Map, PixelsError> {
    let bytes = read_bounded(path)?;
    let names = names_of(&bytes).map_err(|fault| fault.in_file(path))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut levels: Vec<Vec<RgbImage>> = Vec::new();
    for name in names {
        let file = inside(folder, name)
            .map_err(|what| Fault::new(what, "images beside the list").in_file(path))?;
        let faces = read_cube(&read_bounded(&file)?).map_err(|fault| fault.in_file(&file))?;
        let side = faces[0].width;
        if let Some(before) = levels.last()
            && before[0].width / 2 != side
        {
            let what = format!(
                "its faces have {side} texels, the level before {}",
                before[0].width
            );
            return Err(Fault::new(what, "levels that halve").in_file(&file));
        }
        levels.push(faces);
    }
    Ok(Map {
        layout: &LAYOUTS[0],
        levels,
    })
}

/// Lists the images of a list.
fn names_of(bytes: &[u8]) -> Result<Vec<&str>, Fault> {
    let (markup, _) = vtk_xml::split(bytes)?;
    let names: Vec<&str> = markup
        .match_indices("<DataSet ")
        .filter_map(|(start, _)| vtk_xml::attribute(&markup[start..], "DataSet", "file"))
        .collect();
    if names.is_empty() || names.len() > LEVELS_MAX {
        let what = format!("it names {} images", names.len());
        return Err(Fault::new(what, format!("1 to {LEVELS_MAX} levels")));
    }
    Ok(names)
}

/// Reads the six faces of an image of six slices.
fn read_cube(bytes: &[u8]) -> Result<Vec<RgbImage>, Fault> {
    let (markup, _) = vtk_xml::split(bytes)?;
    let extent: Vec<usize> = vtk_xml::attribute(markup, "ImageData", "WholeExtent")
        .unwrap_or_default()
        .split_whitespace()
        .filter_map(|word| word.parse().ok())
        .collect();
    let expected = "a cube of square faces in three channels";
    let side = match extent[..] {
        [0, x, 0, y, 0, 5] if x == y && x < 1024 => x + 1,
        _ => return Err(Fault::new(format!("its extent is {extent:?}"), expected)),
    };
    let array = vtk_xml::read(bytes)?;
    let (texels, _) = array.values.as_chunks::<CHANNELS>();
    if array.component_count != CHANNELS || array.values.len() != FACES * side * side * CHANNELS {
        let what = format!(
            "it has {} numbers in {} channels",
            array.values.len(),
            array.component_count
        );
        return Err(Fault::new(what, expected));
    }
    if let Some(odd) = array.values.iter().find(|value| !value.is_finite()) {
        return Err(Fault::new(format!("a texel is {odd}"), "finite values"));
    }
    let face = |texels: &[[f32; CHANNELS]]| Pixels::new(side as u32, side as u32, texels.to_vec());
    Ok(texels.chunks_exact(side * side).map(face).collect())
}

/// Writes the list of `count` levels.
pub fn list(name: &str, count: usize) -> String {
    let mut text = "<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\" \
                    byte_order=\"LittleEndian\" header_type=\"UInt64\">\n  \
                    <vtkMultiBlockDataSet>\n"
        .to_owned();
    for level in 0..count {
        let file = level_name(name, level);
        writeln!(text, "    <DataSet index=\"{level}\" file=\"{file}\"/>")
            .expect("memory does not fail");
    }
    text + "  </vtkMultiBlockDataSet>\n</VTKFile>\n"
}

/// Writes the image of a level.
pub fn cube(faces: &[RgbImage]) -> Vec<u8> {
    let last = faces[0].width - 1;
    let extent = format!("0 {last} 0 {last} 0 5");
    let header = format!(
        "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\">\n  <ImageData WholeExtent=\"{extent}\" Origin=\"0 0 0\" \
         Spacing=\"1 1 1\" Direction=\"1 0 0 0 1 0 0 0 1\">\n    <Piece Extent=\"{extent}\">\n      \
         <PointData Scalars=\"ImageScalars\">\n        <DataArray type=\"Float32\" \
         Name=\"ImageScalars\" NumberOfComponents=\"3\" format=\"appended\" offset=\"0\"/>\n      \
         </PointData>\n      <CellData>\n      </CellData>\n    </Piece>\n  </ImageData>\n  \
         <AppendedData encoding=\"raw\">\n   _"
    );
    let values: Vec<u8> = faces
        .iter()
        .flat_map(|face| face.data.as_flattened())
        .flat_map(|value| value.to_le_bytes())
        .collect();
    let length = (values.len() as u64).to_le_bytes();
    let end = b"\n  </AppendedData>\n</VTKFile>\n";
    [header.as_bytes(), &length, &values, end].concat()
}
