//! Scenes: cameras, spheres, meshes, materials, direct lights.

pub mod builtin;
pub mod camera;
mod gltf;
mod hasher;
pub mod light;
mod maps;
pub mod material;
pub mod mesh;
mod meshes;
mod obj;
mod shader_ball;
mod source;
mod tangents;

pub use builtin::{SCENES, SceneEntry, is_design};
pub use camera::{Camera, CameraKind, Orbit, Projection};
pub use light::{Light, LightChange};
pub use maps::Texture;
pub use material::{
    Anisotropy, Coat, Emission, Material, MaterialMaps, MaterialOverride, NoDielectric, Sheen,
    SpecularWeight, UnderCoat,
};
pub use mesh::Mesh;
pub use meshes::Meshes;
pub use source::SceneFiles;

use super::environment::GUIDE;
use crate::base::names::suggestion;
use crate::base::pixels::lookup::Wrap;
use crate::instrument::brdf::UnderCoatLaw;
use glam::DVec3;
use hasher::SceneHasher;
use std::path::Path;
use std::sync::Arc;

/// An exact sphere, never tessellated.
#[derive(Clone, Copy, Debug)]
pub struct Sphere {
    pub center: DVec3,
    pub radius: f64,
    /// Index into [`Scene::materials`].
    pub material: usize,
}

/// Geometry and materials, without a camera.
#[derive(Clone, Debug)]
pub struct Scene {
    /// A built-in name or a path.
    pub name: String,
    pub spheres: Vec<Sphere>,
    pub meshes: Meshes,
    pub materials: Vec<Material>,
    pub textures: Arc<[Texture]>,
    pub lights: Vec<Light>,
    /// Whether each pixel is an independent experiment (`gbuffer::design`).
    pub is_design: bool,
    /// Unit vector to the automatic cameras: +z for spheres, 30 degrees right of it and 20 degrees
    /// above for files.
    pub toward_viewer: DVec3,
    /// blake3 (hex) of everything but names.
    pub hash: String,
    /// One sentence each.
    pub warnings: Vec<String>,
}

/// Why a scene could not be loaded.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// A file whose contents cannot be used.
    #[error("{0} ({GUIDE})")]
    Unusable(String),
    /// No file of a known format.
    #[error("{0}")]
    NotFound(String),
}

impl SceneError {
    fn of_file(path: &Path, what: impl std::fmt::Display) -> Self {
        Self::Unusable(format!("{}: {what}", path.display()))
    }

    fn of_line(path: &Path, line: usize, what: impl std::fmt::Display) -> Self {
        Self::Unusable(format!("{}:{line}: {what}", path.display()))
    }

    /// Reads a scene's own file.
    fn reading(path: &Path, files: &dyn SceneFiles) -> Result<Vec<u8>, Self> {
        files.read(path).map_err(|error| {
            Self::NotFound(format!(
                "{}: cannot read the scene: {error}",
                path.display()
            ))
        })
    }
}

pub struct SceneFormat {
    /// Lower case.
    pub extension: &'static str,
    /// One line for `splitsum list scenes`.
    pub about: &'static str,
    read: fn(&str, &Path, &dyn SceneFiles) -> Result<Scene, SceneError>,
}

pub static SCENE_FORMATS: &[SceneFormat] = &[
    SceneFormat {
        extension: "obj",
        about: "triangles with the materials of its MTL file, framed automatically",
        read: obj::load,
    },
    SceneFormat {
        extension: "glb",
        about: "glTF 2.0 in one file: metallic-roughness materials with their maps, framed \
                automatically",
        read: gltf::load,
    },
    SceneFormat {
        extension: "gltf",
        about: "glTF 2.0 with the files that it names",
        read: gltf::load,
    },
];

/// Finds the format by a file's extension.
pub fn scene_format(path: &Path) -> Option<&'static SceneFormat> {
    let extension = path.extension()?.to_string_lossy().to_lowercase();
    SCENE_FORMATS
        .iter()
        .find(|format| format.extension == extension)
}

/// Joins the extensions: `.obj, .glb or .gltf`.
pub fn scene_extensions() -> String {
    let dotted: Vec<String> = SCENE_FORMATS
        .iter()
        .map(|format| format!(".{}", format.extension))
        .collect();
    let (last, others) = dotted.split_last().expect("there are formats");
    format!("{} or {last}", others.join(", "))
}

/// Returns the direction to automatic cameras of files, which see a front, a side and the top.
fn toward_viewer_of_files() -> DVec3 {
    toward(30.0, 20.0)
}

/// Returns the unit vector at an azimuth to the right of +z and an elevation, degrees.
fn toward(azimuth_deg: f64, elevation_deg: f64) -> DVec3 {
    let azimuth = azimuth_deg.to_radians();
    let elevation = elevation_deg.to_radians();
    DVec3::new(
        azimuth.sin() * elevation.cos(),
        elevation.sin(),
        azimuth.cos() * elevation.cos(),
    )
}

impl Scene {
    /// Loads an entry of [`SCENES`], or a file relative to `base_dir`.
    pub fn load(spec: &str, base_dir: &Path) -> Result<Self, SceneError> {
        if let Some(entry) = SCENES.iter().find(|entry| entry.name == spec) {
            return Ok((entry.build)());
        }
        let path = base_dir.join(spec);
        match scene_format(&path) {
            Some(format) => (format.read)(spec, &path, &source::Disk),
            None if path.extension().is_some() && path.exists() => {
                let expected = scene_extensions();
                Err(SceneError::NotFound(format!(
                    "{}: expected a scene file: {expected}",
                    path.display()
                )))
            }
            None => {
                let names: Vec<&str> = SCENES.iter().map(|entry| entry.name).collect();
                let known = names.join(", ");
                let near = suggestion(spec, &names);
                let files = scene_extensions();
                let what = format!(
                    "neither a built-in scene ({known}) nor the path of a file ({files}){near}"
                );
                Err(SceneError::NotFound(format!("scene \"{spec}\": {what}")))
            }
        }
    }

    pub fn sphere() -> Self {
        builtin::sphere()
    }

    /// Loads the scene at `path` of `files`, which also contain its materials, maps and buffers.
    pub fn from_file(path: &Path, files: &dyn SceneFiles) -> Result<Self, SceneError> {
        let format =
            scene_format(path).ok_or_else(|| SceneError::of_file(path, "not a scene file"))?;
        (format.read)(&path.to_string_lossy(), path, files)
    }

    /// Overrides values of every material.
    pub fn apply(&self, values: &MaterialOverride) -> Self {
        self.with_materials(|material| values.apply(material))
    }

    fn with_materials(&self, change: impl Fn(&Material) -> Material) -> Self {
        let materials = self.materials.iter().map(change).collect();
        Self {
            materials,
            ..self.clone()
        }
        .hashed()
    }

    pub fn has_coat(&self) -> bool {
        self.materials
            .iter()
            .any(|material| material.coat.weight > 0.0)
    }

    pub fn has_sheen(&self) -> bool {
        self.materials
            .iter()
            .any(|material| material.sheen.color != [0.0; 3])
    }

    pub fn has_anisotropy(&self) -> bool {
        self.materials
            .iter()
            .any(|material| material.anisotropy.strength > 0.0)
    }

    pub fn has_emission(&self) -> bool {
        self.materials
            .iter()
            .any(|material| material.emission.color != [0.0; 3])
    }

    pub fn has_lights(&self) -> bool {
        !self.lights.is_empty()
    }

    /// Returns the scene with other lights.
    pub fn lit_by(&self, lights: Vec<Light>) -> Self {
        Self {
            lights,
            ..self.clone()
        }
        .hashed()
    }

    /// Whether a dielectric reflects a share of its interface only.
    pub fn has_specular_weight(&self) -> bool {
        self.materials
            .iter()
            .any(|material| !material.specular.is_full())
    }

    /// Returns the scene whose albedo is the emission.
    pub fn emission(&self) -> Self {
        self.with_materials(Material::as_emission)
    }

    /// Returns the scene without emission.
    pub fn dark(&self) -> Self {
        self.with_materials(|material| Material {
            emission: Emission::default(),
            name: material.name.clone(),
            ..*material
        })
    }

    pub fn has_occlusion(&self) -> bool {
        self.materials
            .iter()
            .any(|material| material.occlusion_map.is_some())
    }

    /// Returns the scene whose albedo is the occlusion.
    pub fn occlusions(&self) -> Self {
        self.with_materials(Material::as_occlusion)
    }

    /// Returns the scene without occlusion.
    pub fn unoccluded(&self) -> Self {
        self.with_materials(|material| Material {
            occlusion_map: None,
            name: material.name.clone(),
            ..*material
        })
    }

    /// Returns the scene whose F0 is the weight of the interfaces.
    pub fn specular_weights(&self) -> Self {
        self.with_materials(Material::as_specular_weight)
    }

    /// Returns the scene whose g-buffer has tangents and strengths of anisotropy in place of
    /// normals and alphas.
    pub fn tangents(&self) -> Self {
        self.with_materials(Material::as_tangent)
    }

    /// Returns the F0 of all materials, which are dielectrics; the error names the first that is
    /// not one, or has another F0.
    pub fn dielectric_f0(&self) -> Result<f32, NoDielectric> {
        let [f0, ..] = self.materials[0].f0;
        for material in &self.materials {
            let is_metal = material.metallic > 0.0;
            let is_other = material.f0 != [f0; 3] || material.f0_map.is_some() || f0 >= 1.0;
            if is_metal || is_other {
                return Err(NoDielectric {
                    material: material.name.clone(),
                    is_metal,
                });
            }
        }
        Ok(f0)
    }

    /// Returns the scene without coats.
    pub fn uncoated(&self) -> Self {
        self.below_coat(UnderCoatLaw::UNCHANGED)
    }

    /// Returns the scene without coats, whose bases have what a renderer changes below them.
    pub fn below_coat(&self, law: UnderCoatLaw) -> Self {
        self.with_materials(|material| material.below_coat(law))
    }

    /// Returns the scene without sheen.
    pub fn without_sheen(&self) -> Self {
        self.with_materials(|material| Material {
            sheen: Sheen::default(),
            name: material.name.clone(),
            ..*material
        })
    }

    /// Returns the sheens as white surfaces.
    pub fn sheen(&self) -> Self {
        self.with_materials(Material::as_sheen)
    }

    /// Returns the scene whose albedo is the colour of the sheen.
    pub fn sheen_colors(&self) -> Self {
        self.with_materials(Material::as_sheen_color)
    }

    /// Returns the coats as surfaces of that F0, without a diffuse term; `alpha` converts their
    /// widths.
    pub fn coat(&self, f0: f32, alpha: fn(f32) -> f32) -> Self {
        self.with_materials(|material| material.as_coat(f0, alpha))
    }

    /// Returns the scene whose albedo is the weight of the coat.
    pub fn coat_weights(&self) -> Self {
        self.with_materials(Material::as_coat_weight)
    }

    /// Returns the smallest and largest corners of the bounding box.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let spheres = self
            .spheres
            .iter()
            .flat_map(|s| [s.center - s.radius, s.center + s.radius]);
        let points = spheres.chain(self.meshes.iter().flat_map(Mesh::corners));
        points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| {
            (low.min(p), high.max(p))
        })
    }

    /// Builds a scene without textures or warnings, seen from +z.
    fn assemble(
        name: &str,
        spheres: Vec<Sphere>,
        meshes: Vec<Mesh>,
        materials: Vec<Material>,
    ) -> Self {
        let unhashed = Self {
            name: name.to_owned(),
            spheres,
            meshes: meshes.into(),
            materials,
            textures: Arc::default(),
            lights: Vec::new(),
            is_design: false,
            toward_viewer: DVec3::Z,
            hash: String::new(),
            warnings: Vec::new(),
        };
        unhashed.hashed()
    }

    /// Sets the hash from everything but names.
    fn hashed(mut self) -> Self {
        let mut hasher = SceneHasher(blake3::Hasher::new());
        hasher.list(&self.toward_viewer.to_array());
        hasher.list(&[u8::from(self.is_design)]);
        for sphere in &self.spheres {
            hasher.list(&sphere.center.extend(sphere.radius).to_array());
            hasher.list(&[sphere.material as u64]);
        }
        hasher.list(&[self.spheres.len() as u64, self.meshes.len() as u64]);
        let mut hasher = self.meshes.hashed_after(hasher);
        hasher.list(&[self.materials.len() as u64]);
        for material in &self.materials {
            hasher.material(material);
        }
        for texture in self.textures.iter() {
            let Wrap(u, v) = texture.wrap;
            hasher.list(&[texture.levels[0].width, u as u32, v as u32]);
            hasher.list(&texture.levels[0].data);
        }
        for light in &self.lights {
            hasher.list(&light.numbers());
        }
        self.hash = hasher.0.finalize().to_hex().to_string();
        self
    }
}
