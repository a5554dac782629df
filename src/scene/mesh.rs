//! Triangle meshes.

use glam::{DVec3, Vec3};

/// An indexed triangle list with one material.
///
/// Every triangle is counter-clockwise seen from its front, which is the side that its normals point to, so the sign of the raster's facing
/// alone tells whether a normal points away from the viewer's side of the surface. (A glTF file may disagree with itself; its winding then
/// tells the front, as in a viewer.)
#[derive(Clone, Debug)]
pub struct Mesh {
    pub positions: Vec<[f32; 3]>,
    /// One unit normal a position.
    pub normals: Vec<[f32; 3]>,
    /// One texture coordinate a position ((0, 0) where the file has none); v points up as in OBJ.
    pub uvs: Vec<[f32; 2]>,
    /// One a position: the unit direction t of growing u, and the sign s of the bitangent `s n x t`, which points to growing v. All 0 where no
    /// normal map is read.
    pub tangents: Vec<[f32; 4]>,
    pub indices: Vec<u32>,
    /// Index into `Scene::materials`.
    pub material: usize,
}

/// A triangle is degenerate if its height is below this part of its longest edge: f64 rounding alone, its normal would be noise.
const DEGENERATE_HEIGHT: f64 = 1e-12;

/// Whether a triangle has no area.
pub(super) fn is_degenerate([a, b, c]: [DVec3; 3]) -> bool {
    let longest_squared = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
    (b - a).cross(c - a).length() <= DEGENERATE_HEIGHT * longest_squared
}

impl Mesh {
    /// A mesh without triangles.
    pub(super) fn empty(material: usize) -> Self {
        let (positions, normals, uvs, tangents, indices) = Default::default();
        Self { positions, normals, uvs, tangents, indices, material }
    }

    /// The position of every corner of every triangle.
    pub fn corners(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.indices.iter().map(|&index| position(&self.positions, index))
    }

    /// The triangles as index triples.
    pub fn triangles(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        self.indices.chunks_exact(3).map(|triangle| [triangle[0], triangle[1], triangle[2]])
    }
}

/// The position with that index, in f64.
pub(super) fn position(positions: &[[f32; 3]], index: u32) -> DVec3 {
    Vec3::from_array(positions[index as usize]).as_dvec3()
}
