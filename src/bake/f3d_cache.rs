//! F3D's cache of a map: the prefiltered cube as a list of levels (`specular.vtm`) beside a folder
//! with an image each (`specular/specular_0.vti`), and nine coefficients of radiance (`sh.vtt`).
//!
//! F3D keeps it in a folder that has the MD5 of the map's file as its name, and reads it back in
//! place of its own filter [F3D 4.0.0, `vtkF3DCachedSpecularTexture`; VTK 9.7.1,
//! `vtkSphericalHarmonics`]. It reads five levels.

use super::parts::Map;
use super::sh::{self, Coefficients};
use super::vtk_xml;
use crate::base::files::inside;
use crate::base::math::spherical_harmonics::COUNT;
use crate::base::pixels::{Fault, Pixels, PixelsError, RgbImage, read_bounded};
use crate::instrument::environment::layout::LAYOUTS;
use crate::instrument::precompute::sh9::reference::Sh9;
use glam::DVec3;
use std::fmt::Write;
use std::path::Path;

/// Extension of the list of levels.
pub const EXTENSION: &str = "vtm";
/// Extension of the file of coefficients.
pub const SH_EXTENSION: &str = "vtt";
/// Name of the conventions in the list of presets.
pub const PRESET: &str = "vtk";

const FACES: usize = 6;
const CHANNELS: usize = 3;
const LEVELS_MAX: usize = 16;

/// Returns the folder of the images beside a list of this name.
pub fn folder_of(name: &str) -> &str {
    name.strip_suffix(".vtm").unwrap_or(name)
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

/// Turns a direction of the cube to the axes of the coefficients.
fn sh_from_cube(cube: DVec3) -> DVec3 {
    DVec3::new(-cube.x, -cube.y, cube.z)
}

/// Reads the coefficients: nine of each channel.
pub fn read_sh(bytes: &[u8]) -> Result<Coefficients, Fault> {
    let array = vtk_xml::read(bytes)?;
    let values = &array.values;
    if array.component_count != COUNT || values.len() != CHANNELS * COUNT {
        let what = format!("it has {} numbers", values.len());
        return Err(Fault::new(what, "nine coefficients of red, green and blue"));
    }
    let stored: Sh9 = std::array::from_fn(|k| {
        DVec3::from_array(std::array::from_fn(|c| values[c * COUNT + k].into()))
    });
    Ok(Coefficients {
        radiance: sh::turned(&stored, sh_from_cube),
        factors: [1.0; COUNT],
    })
}

/// Writes coefficients of radiance in the axes of the cube.
pub fn sh_text(radiance: &Sh9) -> String {
    let stored = sh::turned(radiance, sh_from_cube);
    let row = |channel: usize| {
        let numbers = stored.map(|rgb| (rgb[channel] as f32).to_string());
        format!("          {}\n", numbers.join(" "))
    };
    let rows: String = (0..CHANNELS).map(row).collect();
    format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Table\" version=\"0.1\" \
         byte_order=\"LittleEndian\" header_type=\"UInt32\">\n  <Table>\n    \
         <Piece NumberOfCols=\"1\" NumberOfRows=\"3\">\n      <RowData>\n        \
         <DataArray type=\"Float32\" Name=\"SphericalHarmonics\" NumberOfComponents=\"9\" \
         format=\"ascii\">\n{rows}        </DataArray>\n      </RowData>\n    </Piece>\n  \
         </Table>\n</VTKFile>\n"
    )
}
