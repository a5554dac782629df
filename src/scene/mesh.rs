//! Triangle meshes.

/// An indexed triangle list with one material.
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
