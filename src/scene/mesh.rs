//! Triangle meshes.

use glam::{DVec3, Vec3};

/// An indexed triangle list with one material.
///
/// Every triangle is counter-clockwise seen from the side its normals point to, so the sign of the raster's facing alone tells whether a
/// normal points away from the viewer's side of the surface.
#[derive(Clone, Debug)]
pub struct Mesh {
    pub positions: Vec<[f32; 3]>,
    /// One unit normal a position.
    pub normals: Vec<[f32; 3]>,
    /// One texture coordinate a position ((0, 0) where the file has none); v points up as in OBJ.
    pub uvs: Vec<[f32; 2]>,
    pub indices: Vec<u32>,
    /// Index into `Scene::materials`.
    pub material: usize,
}

impl Mesh {
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
