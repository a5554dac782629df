//! F3D's coefficients of radiance (`sh.vtt`), beside its cache of a map (`super::f3d_cache`) [VTK
//! 9.7.1, `vtkSphericalHarmonics`].

use super::vtk_xml;
use crate::base::math::spherical_harmonics::COUNT;
use crate::base::pixels::Fault;
use crate::instrument::precompute::sh9::reference::{Sh9, turned};
use glam::DVec3;

/// Extension of the file.
pub const EXTENSION: &str = "vtt";

const CHANNELS: usize = 3;

/// Turns a direction of the cube to the axes of the coefficients.
fn sh_from_cube(cube: DVec3) -> DVec3 {
    DVec3::new(-cube.x, -cube.y, cube.z)
}

/// Reads the coefficients, nine of each channel, in the axes of the cube.
pub fn read(bytes: &[u8]) -> Result<Sh9, Fault> {
    let array = vtk_xml::read(bytes)?;
    let values = &array.values;
    if array.component_count != COUNT || values.len() != CHANNELS * COUNT {
        let what = format!("it has {} numbers", values.len());
        return Err(Fault::new(what, "nine coefficients of red, green and blue"));
    }
    let stored: Sh9 = std::array::from_fn(|k| {
        DVec3::from_array(std::array::from_fn(|c| values[c * COUNT + k].into()))
    });
    Ok(turned(&stored, sh_from_cube))
}

/// Writes coefficients in the axes of the cube.
pub fn text(radiance: &Sh9) -> String {
    let stored = turned(radiance, sh_from_cube);
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
