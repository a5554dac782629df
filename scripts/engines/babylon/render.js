// Babylon.js: PBRMaterial.
import { PBRMaterial } from '@babylonjs/core/Materials/PBR/pbrMaterial.js';
import { Color3 } from '@babylonjs/core/Maths/math.color.js';
import { withMaterial } from './scene.js';

const material = (scene, sphere, reflectionTexture) => {
    const made = new PBRMaterial('material', scene);
    Object.assign(made, {
        metallic: sphere.metallic, roughness: sphere.roughness, albedoColor: new Color3(...sphere.base_color), reflectionTexture,
    });
    Object.assign(made.clearCoat, { isEnabled: !!sphere.coat, intensity: sphere.coat ?? 0, roughness: sphere.coat_roughness ?? 0 });
    Object.assign(made.anisotropy, { isEnabled: !!sphere.anisotropy, intensity: sphere.anisotropy ?? 0 });
    return made;
};

export const engine = withMaterial(material);
