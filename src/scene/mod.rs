//! What is looked at: cameras, spheres, meshes, materials, lights.

pub mod builtin;
pub mod camera;
pub mod light;
pub mod material;
pub mod mesh;
mod obj;

pub use builtin::{SCENES, SceneEntry, is_design};
pub use camera::{Camera, CameraKind, Orbit, Projection};
pub use light::{Light, LightKind};
pub use material::{Material, MaterialOverride};
pub use mesh::Mesh;
pub use obj::SceneFiles;

use crate::pixels::RgbImage;
use crate::spelling::suggestion;
use glam::DVec3;
use std::path::Path;

/// An exact (never tessellated) sphere.
#[derive(Clone, Copy, Debug)]
pub struct Sphere {
    pub center: DVec3,
    pub radius: f64,
    /// Index into [`Scene::materials`].
    pub material: usize,
}

/// Geometry and materials; the camera is chosen apart from it.
#[derive(Clone, Debug)]
pub struct Scene {
    /// What the user wrote: `sphere`, `spheres`, `plane` or a path.
    pub name: String,
    pub spheres: Vec<Sphere>,
    pub meshes: Vec<Mesh>,
    pub materials: Vec<Material>,
    /// Albedo textures, linear RGB; [`Material::albedo_map`] indexes them.
    pub textures: Vec<RgbImage>,
    /// Whether each pixel is an experiment of its own (`gbuffer::design`); its geometry is then only a stand-in.
    pub is_design: bool,
    /// Unit vector from the scene to its automatic cameras: +z for spheres, 30 degrees to the right of it and 20 degrees above for OBJ files.
    pub toward_viewer: DVec3,
    /// blake3 (hex) of everything that determines the geometry, materials, textures and automatic cameras. Names are left out.
    pub hash: String,
    /// Odd but usable facts about the input, one sentence each.
    pub warnings: Vec<String>,
}

/// Why a scene could not be loaded: the place, what is wrong and what was expected.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct SceneError(String);

impl SceneError {
    /// The file as a whole is wrong.
    fn of_file(path: &Path, what: impl std::fmt::Display) -> Self {
        Self(format!("{}: {what}", path.display()))
    }

    /// One line of the file is wrong.
    fn of_line(path: &Path, line: usize, what: impl std::fmt::Display) -> Self {
        Self(format!("{}:{line}: {what}", path.display()))
    }
}

impl Scene {
    /// The scene that `spec` names: an entry of [`SCENES`] or the path of an OBJ file, which is relative to `base_dir` unless absolute.
    pub fn load(spec: &str, base_dir: &Path) -> Result<Self, SceneError> {
        if let Some(entry) = SCENES.iter().find(|entry| entry.name == spec) {
            return Ok((entry.build)());
        }
        let path = base_dir.join(spec);
        let extension = Path::new(spec).extension().map(|extension| extension.to_string_lossy().to_lowercase());
        match extension.as_deref() {
            Some("obj") => obj::load(spec, &path, &obj::Disk),
            Some(_) if path.exists() => Err(SceneError::of_file(&path, "scene files must be Wavefront OBJ (.obj)")),
            _ => {
                let names: Vec<&str> = SCENES.iter().map(|entry| entry.name).collect();
                let (known, near) = (names.join(", "), suggestion(spec, &names));
                let what = format!("neither a built-in scene ({known}) nor the path of an .obj file{near}");
                Err(SceneError(format!("scene \"{spec}\": {what}")))
            }
        }
    }

    /// The built-in scene `sphere`.
    pub fn sphere() -> Self {
        builtin::sphere()
    }

    /// The scene of the OBJ file at `path` of `files`, which also give what it names.
    pub fn from_obj(path: &Path, files: &dyn SceneFiles) -> Result<Self, SceneError> {
        obj::load(&path.to_string_lossy(), path, files)
    }

    /// The same scene with the override's values in every material.
    pub fn apply(&self, values: &MaterialOverride) -> Self {
        let materials = self.materials.iter().map(|material| values.apply(material)).collect();
        Self { materials, ..self.clone() }.hashed()
    }

    /// The corners (smallest, largest) of the axis-aligned box around everything.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let spheres = self.spheres.iter().flat_map(|s| [s.center - s.radius, s.center + s.radius]);
        let points = spheres.chain(self.meshes.iter().flat_map(Mesh::corners));
        points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
    }

    /// A scene without textures or warnings that is looked at from +z.
    fn assemble(name: &str, spheres: Vec<Sphere>, meshes: Vec<Mesh>, materials: Vec<Material>) -> Self {
        let unhashed = Self {
            name: name.to_owned(),
            spheres,
            meshes,
            materials,
            textures: Vec::new(),
            is_design: false,
            toward_viewer: DVec3::Z,
            hash: String::new(),
            warnings: Vec::new(),
        };
        unhashed.hashed()
    }

    /// The same scene with `hash` computed anew.
    fn hashed(mut self) -> Self {
        let mut hasher = blake3::Hasher::new();
        // Every list is preceded by its length, so that no two scenes feed the same bytes.
        fn list<T: bytemuck::NoUninit>(hasher: &mut blake3::Hasher, values: &[T]) {
            hasher.update(&(values.len() as u64).to_ne_bytes());
            hasher.update(bytemuck::cast_slice(values));
        }
        list(&mut hasher, &self.toward_viewer.to_array());
        list(&mut hasher, &[u8::from(self.is_design)]);
        for sphere in &self.spheres {
            list(&mut hasher, &sphere.center.extend(sphere.radius).to_array());
            list(&mut hasher, &[sphere.material as u64]);
        }
        list(&mut hasher, &[self.spheres.len() as u64, self.meshes.len() as u64]);
        for mesh in &self.meshes {
            list(&mut hasher, &mesh.positions);
            list(&mut hasher, &mesh.normals);
            list(&mut hasher, &mesh.uvs);
            list(&mut hasher, &mesh.indices);
            list(&mut hasher, &[mesh.material as u64]);
        }
        list(&mut hasher, &[self.materials.len() as u64]);
        for material in &self.materials {
            list(&mut hasher, &material.albedo);
            list(&mut hasher, &[material.metallic, material.alpha]);
            list(&mut hasher, &material.f0);
            list(&mut hasher, &[material.albedo_map.map_or(0, |map| map as u64 + 1)]);
        }
        for texture in &self.textures {
            list(&mut hasher, &[texture.width]);
            list(&mut hasher, &texture.data);
        }
        self.hash = hasher.finalize().to_hex().to_string();
        self
    }
}
