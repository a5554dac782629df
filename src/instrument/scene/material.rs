//! Metallic-workflow materials.

use crate::base::glsl::constants::ALPHA_MIN;
use crate::instrument::brdf::UnderCoatLaw;

/// F0 of a common dielectric (index of refraction 1.5).
pub const DEFAULT_F0: f32 = 0.04;
/// Default albedo, linear grey.
pub const DEFAULT_ALBEDO: f32 = 0.8;
/// Default microfacet width.
pub const DEFAULT_ALPHA: f32 = 0.25;

/// A clear coat over a surface (`crate::instrument::shade::coat`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coat {
    /// From 0, no coat, to 1.
    pub weight: f32,
    /// Index into `Scene::textures`; red multiplies `weight`.
    pub weight_map: Option<usize>,
    /// Microfacet width in (0, 1].
    pub alpha: f32,
    /// Index into `Scene::textures`; the square of green multiplies `alpha`.
    pub roughness_map: Option<usize>,
    /// Index into `Scene::textures`; normals of the coat, which has none of the base's.
    pub normal_map: Option<usize>,
}

impl Default for Coat {
    fn default() -> Self {
        Self {
            weight: 0.0,
            weight_map: None,
            alpha: ALPHA_MIN,
            roughness_map: None,
            normal_map: None,
        }
    }
}

/// The coat that changes a base, which has no other coat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnderCoat {
    pub law: UnderCoatLaw,
    pub coat: Coat,
}

/// Sheen over a surface (`crate::instrument::shade::sheen`), with the normal of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheen {
    /// Linear RGB in [0, 1]; black has none.
    pub color: [f32; 3],
    /// Index into `Scene::textures`; multiplies `color`.
    pub color_map: Option<usize>,
    /// Width from [`crate::instrument::brdf::SHEEN_ALPHA_MIN`] to 1.
    pub alpha: f32,
    /// Index into `Scene::textures`; the square of green multiplies `alpha`.
    pub roughness_map: Option<usize>,
}

impl Default for Sheen {
    fn default() -> Self {
        Self {
            color: [0.0; 3],
            color_map: None,
            alpha: DEFAULT_ALPHA,
            roughness_map: None,
        }
    }
}

/// Two widths of the lobe (`crate::instrument::brdf::anisotropy`).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Anisotropy {
    /// From 0, one width, to 1.
    pub strength: f32,
    /// Turns the direction of the larger width counter-clockwise about the normal, radians.
    pub turn: f32,
    /// Index into `Scene::textures`; directions in tangent space, whose lengths multiply
    /// `strength`.
    pub map: Option<usize>,
    /// Whether the g-buffer has the tangent and the strength in place of normal and alpha.
    pub is_shown: bool,
}

/// Light that a surface emits in every direction, in the unit of the environment's radiance. A coat
/// lies over it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Emission {
    /// Radiance, linear RGB, at least 0.
    pub color: [f32; 3],
    /// Index into `Scene::textures`; multiplies `color`.
    pub map: Option<usize>,
}

/// The share of a dielectric's interface that reflects: F is `weight` times Schlick's of f0. Metals
/// have all of theirs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpecularWeight {
    /// From 0 to 1.
    pub factor: f32,
    /// Index into `Scene::textures`; red multiplies `factor`.
    pub map: Option<usize>,
}

impl Default for SpecularWeight {
    fn default() -> Self {
        Self {
            factor: 1.0,
            map: None,
        }
    }
}

impl SpecularWeight {
    pub fn is_full(&self) -> bool {
        self.factor == 1.0 && self.map.is_none()
    }
}

/// A surface. Its F0 is `mix(f0, albedo, metallic)`, its diffuse albedo `(1 - metallic) albedo`.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    pub name: String,
    /// Linear RGB in [0, 1].
    pub albedo: [f32; 3],
    /// Index into `Scene::textures`; multiplies `albedo`.
    pub albedo_map: Option<usize>,
    pub metallic: f32,
    /// Index into `Scene::textures`; blue multiplies `metallic`.
    pub metallic_map: Option<usize>,
    /// Microfacet width in (0, 1].
    pub alpha: f32,
    /// Index into `Scene::textures`; the square of green multiplies `alpha`.
    pub roughness_map: Option<usize>,
    /// Dielectric F0, linear RGB. A file's may exceed 1 under a map, which is multiplied first.
    pub f0: [f32; 3],
    /// Index into `Scene::textures`; multiplies `f0`.
    pub f0_map: Option<usize>,
    pub specular: SpecularWeight,
    /// Index into `Scene::textures`; tangent-space normals of any length.
    pub normal_map: Option<usize>,
    pub anisotropy: Anisotropy,
    pub coat: Coat,
    pub under_coat: Option<UnderCoat>,
    pub sheen: Sheen,
    pub emission: Emission,
    /// Index into `Scene::textures`; red is the share of the image-based light that arrives, in
    /// [0, 1].
    pub occlusion_map: Option<usize>,
    /// Culls back faces. Otherwise their normals are negated.
    pub is_one_sided: bool,
}

/// Indices into `Scene::textures` for the g-buffer's pass: albedo, metallic, roughness, normal, f0,
/// specular weight, weight and roughness of the coat that changes the base.
pub type MaterialMaps = [Option<usize>; 8];

impl Material {
    pub fn maps(&self) -> MaterialMaps {
        [
            self.albedo_map,
            self.metallic_map,
            self.roughness_map,
            self.normal_map,
            self.f0_map,
            self.specular.map,
            self.under_coat.and_then(|under| under.coat.weight_map),
            self.under_coat.and_then(|under| under.coat.roughness_map),
        ]
    }

    /// The base below the coat.
    pub(super) fn below_coat(&self, law: UnderCoatLaw) -> Self {
        let is_changed = self.coat.weight > 0.0 && law != UnderCoatLaw::UNCHANGED;
        Self {
            name: self.name.clone(),
            coat: Coat::default(),
            under_coat: is_changed.then_some(UnderCoat {
                law,
                coat: self.coat,
            }),
            ..*self
        }
    }

    /// A surface whose tangent and strength of anisotropy replace normal and alpha.
    pub(super) fn as_tangent(&self) -> Self {
        Self {
            name: self.name.clone(),
            normal_map: self.anisotropy.map,
            anisotropy: Anisotropy {
                is_shown: true,
                ..self.anisotropy
            },
            is_one_sided: self.is_one_sided,
            ..Self::default()
        }
    }

    /// The coat as a surface without a diffuse term.
    pub(super) fn as_coat(&self, f0: f32, alpha: fn(f32) -> f32) -> Self {
        Self {
            name: self.name.clone(),
            albedo: [0.0; 3],
            alpha: alpha(self.coat.alpha),
            roughness_map: self.coat.roughness_map,
            f0: [f0; 3],
            normal_map: self.coat.normal_map,
            occlusion_map: self.occlusion_map,
            is_one_sided: self.is_one_sided,
            ..Self::default()
        }
    }

    /// The sheen as a white surface.
    pub(super) fn as_sheen(&self) -> Self {
        Self {
            name: self.name.clone(),
            albedo: [1.0; 3],
            alpha: self.sheen.alpha,
            roughness_map: self.sheen.roughness_map,
            normal_map: self.normal_map,
            occlusion_map: self.occlusion_map,
            is_one_sided: self.is_one_sided,
            ..Self::default()
        }
    }

    /// A surface whose albedo is the colour of the sheen.
    pub(super) fn as_sheen_color(&self) -> Self {
        Self {
            albedo: self.sheen.color,
            albedo_map: self.sheen.color_map,
            ..self.as_coat_weight()
        }
    }

    /// A surface whose albedo is the emission.
    pub(super) fn as_emission(&self) -> Self {
        Self {
            albedo: self.emission.color,
            albedo_map: self.emission.map,
            ..self.as_coat_weight()
        }
    }

    /// A surface whose F0 is the weight of the interface: the specular weight, and 1 for metals.
    pub(super) fn as_specular_weight(&self) -> Self {
        Self {
            name: self.name.clone(),
            albedo: [1.0; 3],
            metallic: self.metallic,
            metallic_map: self.metallic_map,
            f0: [self.specular.factor; 3],
            f0_map: self.specular.map,
            is_one_sided: self.is_one_sided,
            ..Self::default()
        }
    }

    /// A surface whose albedo is the occlusion.
    pub(super) fn as_occlusion(&self) -> Self {
        Self {
            albedo: [1.0; 3],
            albedo_map: self.occlusion_map,
            ..self.as_coat_weight()
        }
    }

    /// A surface whose albedo is the weight of the coat.
    pub(super) fn as_coat_weight(&self) -> Self {
        Self {
            name: self.name.clone(),
            albedo: [self.coat.weight; 3],
            albedo_map: self.coat.weight_map,
            is_one_sided: self.is_one_sided,
            ..Self::default()
        }
    }
}

impl Default for Material {
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
            f0_map: None,
            specular: SpecularWeight::default(),
            normal_map: None,
            anisotropy: Anisotropy::default(),
            coat: Coat::default(),
            under_coat: None,
            sheen: Sheen::default(),
            emission: Emission::default(),
            occlusion_map: None,
            is_one_sided: false,
        }
    }
}

/// A material without the one index of a dielectric.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "and the material {material} {}; set --metallic 0 and --f0 or --ior",
    if *is_metal { "is a metal" } else { "has another F0, a colour or a map" }
)]
pub struct NoDielectric {
    pub material: String,
    /// Else its F0 differs.
    pub is_metal: bool,
}

/// Values for every material of a scene. Each also replaces the map.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MaterialOverride {
    pub albedo: Option<[f32; 3]>,
    pub metallic: Option<f32>,
    pub alpha: Option<f32>,
    pub f0: Option<[f32; 3]>,
    pub anisotropy: Option<f32>,
    /// Radians.
    pub anisotropy_turn: Option<f32>,
    pub coat: Option<f32>,
    pub coat_alpha: Option<f32>,
    pub sheen_color: Option<[f32; 3]>,
    pub sheen_alpha: Option<f32>,
}

impl MaterialOverride {
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
            f0_map: material.f0_map.filter(|_| self.f0.is_none()),
            specular: if self.f0.is_none() {
                material.specular
            } else {
                SpecularWeight::default()
            },
            anisotropy: Anisotropy {
                strength: self.anisotropy.unwrap_or(material.anisotropy.strength),
                turn: self.anisotropy_turn.unwrap_or(material.anisotropy.turn),
                map: material
                    .anisotropy
                    .map
                    .filter(|_| self.anisotropy.is_none() && self.anisotropy_turn.is_none()),
                ..material.anisotropy
            },
            coat: Coat {
                weight: self.coat.unwrap_or(material.coat.weight),
                weight_map: material.coat.weight_map.filter(|_| self.coat.is_none()),
                alpha: self.coat_alpha.unwrap_or(material.coat.alpha),
                roughness_map: material
                    .coat
                    .roughness_map
                    .filter(|_| self.coat_alpha.is_none()),
                ..material.coat
            },
            sheen: Sheen {
                color: self.sheen_color.unwrap_or(material.sheen.color),
                color_map: material
                    .sheen
                    .color_map
                    .filter(|_| self.sheen_color.is_none()),
                alpha: self.sheen_alpha.unwrap_or(material.sheen.alpha),
                roughness_map: material
                    .sheen
                    .roughness_map
                    .filter(|_| self.sheen_alpha.is_none()),
            },
            ..*material
        }
    }
}
