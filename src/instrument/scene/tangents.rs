//! Missing normals, and missing tangents by MikkTSpace \[Mikkelsen08\].

use super::mesh::{Mesh, position};
use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};

/// Gives every corner its own vertex and, if `is_flat`, its triangle's normal and no tangent.
pub fn corners(mesh: &Mesh, is_flat: bool) -> Mesh {
    let at = |index: &u32| *index as usize;
    let mut corners = Mesh::empty(mesh.material);
    corners.positions = mesh.indices.iter().map(|i| mesh.positions[at(i)]).collect();
    corners.uvs = mesh.indices.iter().map(|i| mesh.uvs[at(i)]).collect();
    let tangent = |index: &u32| {
        if is_flat {
            [0.0; 4]
        } else {
            mesh.tangents[at(index)]
        }
    };
    corners.tangents = mesh.indices.iter().map(tangent).collect();
    corners.indices = (0..mesh.indices.len() as u32).collect();
    corners.normals = if is_flat {
        let face = |triangle: [u32; 3]| {
            let [a, b, c] = triangle.map(|index| position(&mesh.positions, index));
            [(b - a).cross(c - a).normalize().as_vec3().to_array(); 3]
        };
        mesh.triangles().flat_map(face).collect()
    } else {
        mesh.indices.iter().map(|i| mesh.normals[at(i)]).collect()
    };
    corners
}

/// Computes the missing tangents, all 0, of a mesh from [`corners`]. v points up, as a normal map's
/// green does (glTF 2.0, 3.9.3). Corners without area in texture space keep none.
pub fn fill_missing(mesh: &mut Mesh) {
    let given = mesh.tangents.clone();
    mesh.tangents.fill([0.0; 4]);
    let _: Result<(), _> = generate_tangents(&mut Corners(mesh));
    for (tangent, given) in mesh.tangents.iter_mut().zip(given) {
        if given != [0.0; 4] {
            *tangent = given;
        }
    }
}

struct Corners<'a>(&'a mut Mesh);

impl Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.0.indices.len() / 3
    }

    fn num_vertices_of_face(&self, _: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.0.positions[3 * face + corner]
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.0.normals[3 * face + corner]
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        self.0.uvs[3 * face + corner]
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        self.0.tangents[3 * face + corner] =
            space.map_or([0.0; 4], |space| space.tangent_encoded());
    }
}
