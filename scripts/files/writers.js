// Writes the marker map as Babylon.js, PlayCanvas and gainmap-js do in a browser, and posts each file, or an error, to browser.py.
import '@babylonjs/core/Engines/Extensions/engine.readTexture.js';
import '@babylonjs/core/Engines/Extensions/engine.renderTargetCube.js';
import '@babylonjs/core/Materials/Textures/baseTexture.polynomial.js';
import { Engine } from '@babylonjs/core/Engines/engine.js';
import { HDRCubeTexture } from '@babylonjs/core/Materials/Textures/hdrCubeTexture.js';
import { CreateEnvTextureAsync } from '@babylonjs/core/Misc/environmentTextureTools.js';
import { Scene } from '@babylonjs/core/scene.js';
import { compress, encode, findTextureMinMax } from '@monogrid/gainmap-js/encode';
import { encodeJPEGMetadata } from '@monogrid/gainmap-js/libultrahdr';
import * as pc from 'playcanvas';
import * as THREE from 'three';

const fetched = async (name) => new Uint8Array(await (await fetch(name)).arrayBuffer());
const [width, height] = [256, 128];
const floats = new Float32Array((await fetched('g.raw')).buffer);
const lamps = new Float32Array((await fetched('lamps.raw')).buffer);
const canvas = () => document.createElement('canvas');

// A map prefiltered by Babylon.js; the type names the pictures in the file.
const babylon = async (imageType) => {
    const scene = new Scene(new Engine(canvas(), false));
    const texture = await new Promise((loaded, failed) => {
        const map = new HDRCubeTexture('g.hdr', scene, 64, false, true, false, true, () => loaded(map), failed);
    });
    return new Uint8Array(await CreateEnvTextureAsync(texture, { imageType, imageQuality: 1 }));
};

// The texels of an atlas, four bytes each.
const playCanvas = async (radiance) => {
    const { graphicsDevice: device } = new pc.Application(canvas(), {});
    const source = new pc.Texture(device, {
        width, height, format: pc.PIXELFORMAT_RGBA32F, projection: pc.TEXTUREPROJECTION_EQUIRECT,
        mipmaps: false, addressU: pc.ADDRESS_REPEAT, addressV: pc.ADDRESS_CLAMP_TO_EDGE,
        minFilter: pc.FILTER_NEAREST, magFilter: pc.FILTER_NEAREST, levels: [radiance],
    });
    const atlas = pc.EnvLighting.generateAtlas(pc.EnvLighting.generateLightingSource(source));
    return new Uint8Array(await atlas.read(0, 0, atlas.width, atlas.height));
};

const gainMap = async () => {
    const image = new THREE.DataTexture(floats, width, height, THREE.RGBAFormat, THREE.FloatType);
    image.flipY = true;
    image.needsUpdate = true;
    const encoded = encode({ image, maxContentBoost: Math.max(...findTextureMinMax(image)) });
    const [sdr, gains] = await Promise.all([encoded.sdr, encoded.gainMap].map((target) => compress({
        source: new ImageData(target.toArray(), target.width, target.height), mimeType: 'image/jpeg', quality: 0.9, flipY: true,
    })));
    return encodeJPEGMetadata({ ...encoded, ...encoded.getMetadata(), sdr, gainMap: gains });
};

// Rejects what does not end.
const within = (seconds, promise) => Promise.race([
    promise, new Promise((_, reject) => setTimeout(() => reject(new Error(`no end after ${seconds} s`)), 1000 * seconds)),
]);

const writers = {
    'babylon-png.env': () => babylon('image/png'),
    'babylon-webp.env': () => babylon('image/webp'),
    'playcanvas.rgba': () => playCanvas(floats),
    'playcanvas-lamps.rgba': () => playCanvas(lamps),
    'gainmap.jpg': gainMap,
};
for (const [name, write] of Object.entries(writers)) {
    const [path, body] = await within(20, write()).then((bytes) => [name, bytes], (error) => [`${name}.error`, error?.message ?? String(error)]);
    await fetch(path, { method: 'POST', body });
}
await fetch('done', { method: 'POST' });
