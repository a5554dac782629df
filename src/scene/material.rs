//! Metallic-workflow materials.

/// Reflectance at normal incidence of a common dielectric (index of refraction 1.5).
pub const DEFAULT_F0: f32 = 0.04;
/// Linear grey of a surface that names no colour.
pub const DEFAULT_ALBEDO: f32 = 0.8;
/// Microfacet width of a surface that names none.
pub const DEFAULT_ALPHA: f32 = 0.25;

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

impl Default for Material {
    /// A grey dielectric: f0 0.04, albedo 0.8, metallic 0, alpha 0.25.
    fn default() -> Self {
        Self {
            name: "default".to_owned(),
            albedo: [DEFAULT_ALBEDO; 3],
            albedo_map: None,
            metallic: 0.0,
            alpha: DEFAULT_ALPHA,
            f0: [DEFAULT_F0; 3],
        }
    }
}

/// Values that replace those of every material of a scene. A replaced albedo takes the place of the albedo map as well.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MaterialOverride {
    pub albedo: Option<[f32; 3]>,
    pub metallic: Option<f32>,
    pub alpha: Option<f32>,
    pub f0: Option<[f32; 3]>,
}

impl MaterialOverride {
    /// `material` with the values of the override.
    pub fn apply(&self, material: &Material) -> Material {
        Material {
            name: material.name.clone(),
            albedo: self.albedo.unwrap_or(material.albedo),
            albedo_map: if self.albedo.is_some() { None } else { material.albedo_map },
            metallic: self.metallic.unwrap_or(material.metallic),
            alpha: self.alpha.unwrap_or(material.alpha),
            f0: self.f0.unwrap_or(material.f0),
        }
    }
}
