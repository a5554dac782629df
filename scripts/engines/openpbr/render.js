// Babylon.js: OpenPBRMaterial.
import { Constants } from '@babylonjs/core/Engines/constants.js';
import { OpenPBRMaterial } from '@babylonjs/core/Materials/PBR/openpbrMaterial.js';
import { RawTexture } from '@babylonjs/core/Materials/Textures/rawTexture.js';
import { Color3 } from '@babylonjs/core/Maths/math.color.js';
import { withMaterial } from '../babylon/scene.js';

// Blue noise from a server, twice the texel less 1, shifts its lookups of an anisotropic lobe; here its mean does.
const noise = (scene) => {
    const texel = new Uint8Array(4).fill(128);
    return RawTexture.CreateRGBATexture(texel, 1, 1, scene, false, false, Constants.TEXTURE_NEAREST_SAMPLINGMODE);
};

const material = (scene, sphere, map) => {
    scene.environmentTexture = map;
    OpenPBRMaterial._noiseTextures[scene.uniqueId] ??= noise(scene);
    const made = new OpenPBRMaterial('material', scene);
    Object.assign(made, {
        baseColor: new Color3(...sphere.base_color), baseMetalness: sphere.metallic, specularRoughness: sphere.roughness, specularIor: 1.5,
        specularRoughnessAnisotropy: sphere.anisotropy ?? 0, coatWeight: sphere.coat ?? 0, coatRoughness: sphere.coat_roughness ?? 0,
        // The light that a coat keeps from its base by reflecting it back is another effect than ours.
        coatIor: 1.5, coatDarkening: 0,
    });
    return made;
};

export const engine = withMaterial(material);
