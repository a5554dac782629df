// three.js: MeshPhysicalMaterial under its own PMREM of the map.
import * as THREE from 'three';
import { EXRLoader } from 'three/examples/jsm/loaders/EXRLoader.js';
import { EXTENT, SIZE, mapUrl } from '../page.js';

// It adds the change of the normal from pixel to pixel to the roughness: 0.02 and more at 96 pixels. So the picture is drawn FINER
// times as large, and the pixel in the middle of each block is kept.
const FINER = 7;
const FINE = FINER * SIZE;

const renderer = new THREE.WebGLRenderer();
const target = new THREE.WebGLRenderTarget(FINE, FINE, { type: THREE.FloatType });
const camera = new THREE.OrthographicCamera(-EXTENT, EXTENT, EXTENT, -EXTENT, 1, 9);
camera.position.z = 5;
const geometry = new THREE.SphereGeometry(1, 512, 256);
geometry.computeTangents();

const light = async (name) => {
    // Its HDRLoader divides the texels of a Radiance file by 255, not by 256: 0.4 % more light.
    const texture = await new EXRLoader().setDataType(THREE.FloatType).loadAsync(mapUrl(name));
    texture.mapping = THREE.EquirectangularReflectionMapping;
    const generator = new THREE.PMREMGenerator(renderer);
    return generator.fromEquirectangular(texture).texture;
};

const draw = (sphere, environment) => {
    const material = new THREE.MeshPhysicalMaterial({
        color: new THREE.Color().setRGB(...sphere.base_color),
        metalness: sphere.metallic,
        roughness: sphere.roughness,
        clearcoat: sphere.coat ?? 0,
        clearcoatRoughness: sphere.coat_roughness ?? 0,
        anisotropy: sphere.anisotropy ?? 0,
    });
    const scene = new THREE.Scene();
    scene.environment = environment;
    scene.environmentRotation.y = ROTATION;
    scene.add(new THREE.Mesh(geometry, material));
    renderer.setRenderTarget(target);
    renderer.render(scene, camera);
    const fine = new Float32Array(4 * FINE * FINE);
    renderer.readRenderTargetPixels(target, 0, 0, FINE, FINE, fine);
    material.dispose();
    const middle = (i) => FINER * i + (FINER - 1) / 2;
    return Float32Array.from({ length: 4 * SIZE * SIZE }, (_, i) => {
        const [x, y] = [Math.floor(i / 4) % SIZE, Math.floor(i / 4 / SIZE)];
        return fine[4 * (middle(y) * FINE + middle(x)) + i % 4];
    });
};

// Its lat-long maps have +x in the centre, ours +z.
const ROTATION = -Math.PI / 2;

export const engine = { light, draw };
