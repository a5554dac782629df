//! Metallic-workflow materials.

/// A surface. The specular reflectance is `mix(f0, albedo, metallic)`; the diffuse albedo is `(1 - metallic) albedo`.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    pub name: String,
    /// Linear RGB in [0, 1].
    pub albedo: [f32; 3],
    /// Index into `Scene::textures`; multiplies `albedo`.
    pub albedo_map: Option<usize>,
    pub metallic: f32,
    /// Microfacet width in (0, 1].
    pub alpha: f32,
    /// Dielectric reflectance at normal incidence, linear RGB.
    pub f0: [f32; 3],
}

/// Values that replace those of every material of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MaterialOverride {
    pub albedo: Option<[f32; 3]>,
    pub metallic: Option<f32>,
    pub alpha: Option<f32>,
    pub f0: Option<[f32; 3]>,
}
