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
    /// Index into `Scene::textures`, whose blue multiplies `metallic`.
    pub metallic_map: Option<usize>,
    /// Microfacet width in (0, 1].
    pub alpha: f32,
    /// Index into `Scene::textures`, whose green is a perceptual roughness: its square multiplies `alpha`.
    pub roughness_map: Option<usize>,
    /// Dielectric reflectance at normal incidence, linear RGB.
    pub f0: [f32; 3],
    /// Index into `Scene::textures`: the normal in coordinates along the tangent, the bitangent and the mesh's normal, of any length.
    pub normal_map: Option<usize>,
    /// Whether backs of triangles are not seen at all. Without it they are shaded with the negated normal.
    pub is_one_sided: bool,
}

impl Material {
    /// Every map.
    pub fn maps(&self) -> impl Iterator<Item = usize> {
        [self.albedo_map, self.metallic_map, self.roughness_map, self.normal_map].into_iter().flatten()
    }
}

impl Default for Material {
    /// A grey dielectric: f0 0.04, albedo 0.8, metallic 0, alpha 0.25.
    fn default() -> Self {
        Self {
            name: "default".to_owned(),
            albedo: [DEFAULT_ALBEDO; 3],
            albedo_map: None,
            metallic: 0.0,
            metallic_map: None,
            alpha: DEFAULT_ALPHA,
            roughness_map: None,
            f0: [DEFAULT_F0; 3],
            normal_map: None,
            is_one_sided: false,
        }
    }
}

/// Values that replace those of every material of a scene. A replaced value takes the place of its map as well.
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
            albedo_map: material.albedo_map.filter(|_| self.albedo.is_none()),
            metallic: self.metallic.unwrap_or(material.metallic),
            metallic_map: material.metallic_map.filter(|_| self.metallic.is_none()),
            alpha: self.alpha.unwrap_or(material.alpha),
            roughness_map: material.roughness_map.filter(|_| self.alpha.is_none()),
            f0: self.f0.unwrap_or(material.f0),
            ..*material
        }
    }
}
