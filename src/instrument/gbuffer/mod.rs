//! The g-buffer: the surface at each pixel's centre, one texel per pixel.
//!
//! Four attachments of four f32, all 0 where nothing is hit; row 0 is the top row:
//!
//! | # | rgb | a |
//! |---|---|---|
//! | 0 | position, world | mask: 1 hit, 0 not |
//! | 1 | unit normal, world | alpha |
//! | 2 | albedo, linear, before `1 - metallic` | metallic |
//! | 3 | f0: `mix(dielectric f0, albedo, metallic)` | index of the material |
//!
//! Where a dielectric reflects a share w of its interface only, F is `mix(w, 1, metallic)` times
//! Schlick's of `f0 = mix(w f0, albedo, metallic) / mix(w, 1, metallic)`; attachment 3 has this f0,
//! and the g-buffer of [`Scene::specular_weights`] the weight.
//!
//! Under a coat of weight c and width alpha_c some renderers change the base
//! ([`Scene::below_coat`]). With r the perceptual roughness and p the polynomial of the law,
//! attachment 3 then has `mix(f0, clamp(p(f0), 0, 1), c)` before the division by `mix(w, 1,
//! metallic)`, and attachment 1 an alpha of the law
//! ([`RoughnessUnderCoat`](crate::instrument::brdf::RoughnessUnderCoat)).
//!
//! Spheres are exact: with c the centre relative to the ray's origin, d the ray's direction and x =
//! d x c, a ray hits if `r² d·d - x·x >= 0`, at `(d x x - sqrt(r² d·d - x·x) d) / d·d` from the
//! centre.
//!
//! Meshes have interpolated positions and normals and are shaded on both sides: seen from the back,
//! the normal is negated. A material may cull backs. Interpolated and mapped normals may lean away
//! from the viewer, `n·v < 0`: those become `normalize(n + (COSINE_MIN - n·v) v)`, and a normal
//! without a direction becomes v (docs/conventions.md). Only this pass reads maps, so every method
//! and the reference see the same surface. Lookups are trilinear with v up, at the level
//! whose texels are as wide as the longer step to a neighbour within a quad of 2 x 2 pixels. With
//! interpolated normal n, tangent t (not renormalised \[Mikkelsen08\]) and m of the normal map, the
//! normal is `normalize(m.x t + m.y s (n x t) + m.z n)`, s the tangent's sign; metallic is
//! multiplied by the map's blue, alpha by its green squared. Devices snap vertices to a sub-pixel
//! grid (1/256 pixel is common), so mesh texels match the twin only to about that much of a pixel;
//! spheres do not depend on it.
//!
//! Lobes of two widths need a tangent, and the strength of the anisotropy. Both are the normals and
//! alphas of a second g-buffer, of [`Scene::tangents`]: in place of a normal m is the direction
//! `(d.x, d.y, 0)` of the material's map (without one +x), turned counter-clockwise, and in place
//! of alpha the strength times the length of d. Spheres, and meshes without tangents or with
//! tangents along their normals, have the tangent of [`crate::base::math::frame::east`]. Shading
//! makes tangents orthogonal to the normal of the first g-buffer.
//!
//! Occlusion is the red of the albedo of another g-buffer, of [`Scene::occlusions`].
//!
//! Draw state: only one-sided meshes are culled, front faces are counter-clockwise, depth test `<`
//! on 1. Spheres: `sphere.vert/frag`, a strip of 4 vertices, one instance per sphere, depth written
//! by the shader. Meshes: `mesh.vert/frag`, indexed triangle lists with position, normal, uv and
//! tangent at locations 0 to 3. Set 0: binding 0 spheres, 1 materials, 2 to 9 the maps of albedo,
//! metallic, roughness, normal, f0, specular weight, and of the coat's weight and roughness.

pub mod design;
pub mod pass;

use crate::base::glsl::layout::{GbufferParams, MaterialData, SphereData};
use crate::base::pixels::{GrayImage, Pixels};
use crate::instrument::scene::{Anisotropy, Camera, Material, Projection, Scene, Sphere};
use glam::DVec3;

pub const ATTACHMENT_NAMES: [&str; 4] = [
    "position-mask",
    "normal-alpha",
    "albedo-metallic",
    "f0-material",
];

/// The four attachments: f32 from the device, f64 from the twin in tests.
#[derive(Clone, Debug, PartialEq)]
pub struct Gbuffer<T> {
    pub position_mask: Pixels<[T; 4]>,
    pub normal_alpha: Pixels<[T; 4]>,
    pub albedo_metallic: Pixels<[T; 4]>,
    pub f0_material: Pixels<[T; 4]>,
}

/// Positions and normals alone, which say what surface each pixel sees.
#[derive(Clone, Debug, PartialEq)]
pub struct Surfaces {
    pub position_mask: Pixels<[f32; 4]>,
    pub normal_alpha: Pixels<[f32; 4]>,
}

impl<T> From<[Pixels<[T; 4]>; 4]> for Gbuffer<T> {
    fn from(
        [position_mask, normal_alpha, albedo_metallic, f0_material]: [Pixels<[T; 4]>; 4],
    ) -> Self {
        Self {
            position_mask,
            normal_alpha,
            albedo_metallic,
            f0_material,
        }
    }
}

impl<T: Copy + Into<f64>> Gbuffer<T> {
    /// Returns 1 for pixels that hit a surface, else 0.
    pub fn mask(&self) -> GrayImage {
        mask(&self.position_mask)
    }

    /// Returns the cosine between normal and view, not clamped; 0 if nothing is hit.
    pub fn n_dot_v(&self, camera: &Camera) -> GrayImage {
        n_dot_v(&self.position_mask, &self.normal_alpha, camera)
    }
}

impl Surfaces {
    /// As [`Gbuffer::mask`].
    pub fn mask(&self) -> GrayImage {
        mask(&self.position_mask)
    }

    /// As [`Gbuffer::n_dot_v`].
    pub fn n_dot_v(&self, camera: &Camera) -> GrayImage {
        n_dot_v(&self.position_mask, &self.normal_alpha, camera)
    }
}

fn mask<T: Copy + Into<f64>>(positions: &Pixels<[T; 4]>) -> GrayImage {
    positions.map(|texel| texel[3].into() as f32)
}

fn n_dot_v<T: Copy + Into<f64>>(
    positions: &Pixels<[T; 4]>,
    normals: &Pixels<[T; 4]>,
    camera: &Camera,
) -> GrayImage {
    let xyz = |texel: [T; 4]| DVec3::new(texel[0].into(), texel[1].into(), texel[2].into());
    Pixels::from_fn(positions.width, positions.height, |x, y| {
        let position = positions.get(x, y);
        if position[3].into() == 0.0 {
            return 0.0;
        }
        xyz(normals.get(x, y)).dot(camera.v_at(xyz(position))) as f32
    })
}

/// Returns the push constants for an image of `size` pixels; `material` is the mesh's (unused by
/// spheres).
pub fn params(camera: &Camera, size: [u32; 2], material: usize) -> GbufferParams {
    let [extent_x, extent_y] = camera.extent(f64::from(size[0]) / f64::from(size[1]));
    let [depth_scale, depth_offset] = camera.depth_scale_offset();
    let vec4 = |xyz: DVec3, w: f64| xyz.extend(w).as_vec4().to_array();
    let perspective = matches!(camera.projection, Projection::Perspective { .. });
    GbufferParams {
        right: vec4(camera.right, extent_x),
        up: vec4(camera.up, extent_y),
        forward: vec4(camera.forward, depth_scale),
        eye: vec4(camera.eye, if perspective { 1.0 } else { 0.0 }),
        depth_offset: depth_offset as f32,
        width: size[0],
        height: size[1],
        material: material as u32,
    }
}

pub fn sphere_data(scene: &Scene) -> Vec<SphereData> {
    let data = |sphere: &Sphere| SphereData {
        center_radius: sphere.center.extend(sphere.radius).as_vec4().to_array(),
        material: [sphere.material as u32, 0, 0, 0],
    };
    scene.spheres.iter().map(data).collect()
}

pub fn material_data(scene: &Scene) -> Vec<MaterialData> {
    let with = |[r, g, b]: [f32; 3], a: f32| [r, g, b, a];
    let data = |material: &Material| MaterialData {
        albedo_metallic: with(material.albedo, material.metallic),
        f0_alpha: with(material.f0, material.alpha),
        tangent: {
            let Anisotropy {
                strength,
                turn,
                is_shown,
                ..
            } = material.anisotropy;
            [
                turn.cos(),
                turn.sin(),
                strength,
                f32::from(u8::from(is_shown)),
            ]
        },
        specular: [material.specular.factor, 0.0, 0.0, 0.0],
        coat: material.under_coat.map_or([0.0; 4], |under| {
            [
                under.coat.weight,
                under.coat.alpha,
                (under.law.roughness as u32) as f32,
                0.0,
            ]
        }),
        f0_under_coat: material.under_coat.map_or([0.0; 4], |under| under.law.f0),
    };
    scene.materials.iter().map(data).collect()
}
