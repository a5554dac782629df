//! The hash of what a scene shows.

use super::material::{Anisotropy, Coat, Emission, Material, Sheen, SpecularWeight, UnderCoat};

/// Hashes lists with their lengths, which keep different scenes from feeding equal bytes.
pub(super) struct SceneHasher(pub(super) blake3::Hasher);

impl SceneHasher {
    pub(super) fn list<T: bytemuck::NoUninit>(&mut self, values: &[T]) {
        self.0.update(&(values.len() as u64).to_ne_bytes());
        self.0.update(bytemuck::cast_slice(values));
    }

    /// Hashes the presence and index of each map.
    fn maps<const N: usize>(&mut self, maps: [Option<usize>; N]) {
        self.list(&maps.map(|map| map.map_or(0, |map| map as u64 + 1)));
    }

    /// Hashes a material; a layer without effect leaves the hash as it was before the layer
    /// existed.
    pub(super) fn material(&mut self, material: &Material) {
        self.list(&material.albedo);
        self.list(&[material.metallic, material.alpha]);
        self.list(&material.f0);
        self.maps([
            material.albedo_map,
            material.metallic_map,
            material.roughness_map,
            material.normal_map,
        ]);
        self.list(&[u8::from(material.is_one_sided)]);
        self.anisotropy(&material.anisotropy);
        self.coat(&material.coat);
        self.sheen(&material.sheen);
        self.emission(&material.emission);
        self.specular(material);
        if material.occlusion_map.is_some() {
            self.maps([material.occlusion_map]);
        }
        if let Some(UnderCoat { law, coat }) = &material.under_coat {
            self.list(&law.f0);
            self.list(&[law.roughness as u64]);
            self.coat(coat);
        }
    }

    fn emission(&mut self, emission: &Emission) {
        let Emission { color, map } = *emission;
        if color != [0.0; 3] {
            self.list(&[color, [0.0; 3]].concat());
            self.maps([map]);
        }
    }

    /// Hashes what `KHR_materials_specular` adds.
    fn specular(&mut self, material: &Material) {
        let SpecularWeight { factor, map } = material.specular;
        if !material.specular.is_full() || material.f0_map.is_some() {
            self.list(&[factor]);
            self.maps([map, material.f0_map]);
        }
    }

    fn anisotropy(&mut self, anisotropy: &Anisotropy) {
        let Anisotropy {
            strength,
            turn,
            map,
            is_shown,
        } = *anisotropy;
        if strength > 0.0 || is_shown {
            self.list(&[strength, turn]);
            let map = map.map_or(0, |map| map as u64 + 1);
            self.list(&[map, u64::from(is_shown)]);
        }
    }

    fn coat(&mut self, coat: &Coat) {
        let Coat {
            weight,
            weight_map,
            alpha,
            roughness_map,
            normal_map,
        } = *coat;
        if weight > 0.0 {
            self.list(&[weight, alpha]);
            self.maps([weight_map, roughness_map, normal_map]);
        }
    }

    fn sheen(&mut self, sheen: &Sheen) {
        let Sheen {
            color,
            color_map,
            alpha,
            roughness_map,
        } = *sheen;
        if color != [0.0; 3] {
            self.list(&[color, [alpha, 0.0, 0.0]].concat());
            self.maps([color_map, roughness_map]);
        }
    }
}
