//! The g-buffer of the scene `design`: pixel i of N is surface i of N of
//! [`crate::base::math::design`].
//!
//! The eye is the origin and positions are -v, so that shading computes the right v.

use super::Gbuffer;
use crate::base::math::design::{frame, tangent};
use crate::base::pixels::Pixels;
use crate::instrument::scene::{Anisotropy, Scene, UnderCoat};
use glam::Vec3;

pub fn gbuffer(scene: &Scene, [width, height]: [u32; 2]) -> Gbuffer<f32> {
    let material = &scene.materials[0];
    let rgb = |values: [f32; 3]| Vec3::from_array(values);
    let mut f0 = rgb(material.f0).lerp(rgb(material.albedo), material.metallic);
    let mut alpha = material.alpha;
    if let Some(UnderCoat { law, coat }) = &material.under_coat {
        let weight = coat.weight.into();
        f0 = law.f0_below(f0.as_dvec3(), weight).as_vec3();
        alpha = law.alpha_below(alpha.into(), weight, coat.alpha.into()) as f32;
    }
    let frames = Pixels::from_fn(width, height, |x, y| frame(y * width + x, width * height));
    let Anisotropy {
        strength,
        turn,
        is_shown,
        ..
    } = material.anisotropy;
    let constant = |xyz: Vec3, w: f32| Pixels::filled(width, height, xyz.extend(w).to_array());
    Gbuffer {
        position_mask: frames.map(|[_, v]| (-v).as_vec3().extend(1.0).to_array()),
        normal_alpha: if is_shown {
            Pixels::from_fn(width, height, |x, y| {
                let tangent = tangent(y * width + x, width * height, turn.into());
                tangent.as_vec3().extend(strength).to_array()
            })
        } else {
            frames.map(|[n, _]| n.as_vec3().extend(alpha).to_array())
        },
        albedo_metallic: constant(rgb(material.albedo), material.metallic),
        f0_material: constant(f0, 0.0),
    }
}
