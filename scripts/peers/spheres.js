// Draws a metal sphere in three.js, Babylon.js and PlayCanvas: each with the bake for it, the engine's own loader, material and factors A
// and B, and the lines to paste that the bake wrote. scripts/check-clients.sh bundles it; it compares with pictures of `splitsum render`.
import * as THREE from 'three';
import { KTX2Loader } from 'three/examples/jsm/loaders/KTX2Loader.js';
import { EXRLoader } from 'three/examples/jsm/loaders/EXRLoader.js';
import { read } from 'ktx-parse';
import { FreeCamera } from '@babylonjs/core/Cameras/freeCamera.js';
import { Constants } from '@babylonjs/core/Engines/constants.js';
import { Engine } from '@babylonjs/core/Engines/engine.js';
import '@babylonjs/core/Engines/Extensions/engine.rawTexture.js';
import { PBRMaterial } from '@babylonjs/core/Materials/PBR/pbrMaterial.js';
import { MaterialPluginBase } from '@babylonjs/core/Materials/materialPluginBase.js';
import { CubeTexture } from '@babylonjs/core/Materials/Textures/cubeTexture.js';
import { RawTexture } from '@babylonjs/core/Materials/Textures/rawTexture.js';
import { RenderTargetTexture } from '@babylonjs/core/Materials/Textures/renderTargetTexture.js';
import '@babylonjs/core/Materials/Textures/Loaders/ddsTextureLoader.js';
import { Color3, Color4 } from '@babylonjs/core/Maths/math.color.js';
import { Vector3 } from '@babylonjs/core/Maths/math.vector.js';
import { CreateSphere } from '@babylonjs/core/Meshes/Builders/sphereBuilder.js';
import { Scene } from '@babylonjs/core/scene.js';
import * as pc from 'playcanvas';

const SIZE = 128;
// The perspective camera of `render`: distance from the unit sphere's centre on +z, and vertical field of view in degrees.
const [DISTANCE, FOV] = [4, 32];
const F0 = [1, 0.5, 0.2];

const bytes = (name) => Uint8Array.from(atob(FILES[name]), (c) => c.charCodeAt(0));
const url = (name) => `data:application/octet-stream;base64,${FILES[name]}`;
const canvas = () => Object.assign(document.createElement('canvas'), { width: SIZE, height: SIZE });
// Half floats, width and height of a table in KTX 2.
const table = (name) => {
    const { pixelWidth, pixelHeight, levels } = read(bytes(name));
    return [new Uint16Array(levels[0].levelData.slice().buffer), pixelWidth, pixelHeight];
};
// The functions, and the lines for the place of the lookup with the engine's name for the map.
const pasted = (engine, map) => {
    const [functions, rest] = atob(FILES[`${engine}/taps.glsl`]).split('// Replaces ');
    const lines = rest.split('\n').filter((line) => line.startsWith('//     ')).map((line) => line.slice(7));
    return [functions, lines.join('\n').replaceAll(/\bmap\b/g, map)];
};

const inThree = async (roughness) => {
    const renderer = new THREE.WebGLRenderer();
    const loader = new KTX2Loader().detectSupport(renderer);
    const [found, taps] = await Promise.all(['specular', 'taps'].map((name) => loader.loadAsync(url(`three/${name}.ktx2`))));
    Object.assign(taps, { minFilter: THREE.LinearFilter, magFilter: THREE.LinearFilter });
    // KTX2Loader leaves the six faces of a level together.
    const faces = [0, 1, 2, 3, 4, 5].map((face) => ({ ...found.image, mipmaps: found.mipmaps.map((level) => {
        const count = level.data.length / 6;
        return { ...level, data: level.data.subarray(face * count, (face + 1) * count) };
    }) }));
    const map = new THREE.CompressedCubeTexture(faces, found.format, found.type);
    Object.assign(map, { minFilter: THREE.LinearMipmapLinearFilter, isPMREMTexture: true, needsUpdate: true });
    const material = new THREE.MeshStandardMaterial({ metalness: 1, roughness, color: new THREE.Color().setRGB(...F0) });
    const [functions, lines] = pasted('three', 'envMap');
    material.onBeforeCompile = (shader) => {
        shader.uniforms.taps = { value: taps };
        shader.fragmentShader = shader.fragmentShader
            .replace('void main() {', `uniform sampler2D taps;\n${functions}\nvoid main() {`)
            .replace('#include <lights_fragment_end>', `#include <lights_fragment_end>
                {
                    vec3 n = envMapRotation * transformDirectionByInverseViewMatrix(geometryNormal, viewMatrix);
                    vec3 v = envMapRotation * transformDirectionByInverseViewMatrix(geometryViewDir, viewMatrix);
                    vec3 f0 = material.specularColorBlended;
                    float n_dot_v = dot(n, v);
                    vec2 dfg = texture2D(dfgLUT, vec2(roughness, n_dot_v)).rg;
                    ${lines}
                    reflectedLight.indirectSpecular = specular;
                }`);
    };
    const scene = new THREE.Scene();
    scene.environment = map;
    scene.add(new THREE.Mesh(new THREE.SphereGeometry(1, 256, 256), material));
    const camera = new THREE.PerspectiveCamera(FOV, 1, 1, 9);
    camera.position.z = DISTANCE;
    const target = new THREE.WebGLRenderTarget(SIZE, SIZE, { type: THREE.FloatType });
    renderer.setRenderTarget(target);
    renderer.setClearColor(0, 0);
    renderer.render(scene, camera);
    const picture = new Float32Array(4 * SIZE * SIZE);
    renderer.readRenderTargetPixels(target, 0, 0, SIZE, SIZE, picture);
    return picture;
};

const inBabylon = async (roughness) => {
    const scene = new Scene(new Engine(canvas(), false));
    scene.useRightHandedSystem = true;
    const map = await new Promise((done, fail) => {
        const loaded = () => done(texture);
        const texture = new CubeTexture(url('babylon/specular.dds'), scene, null, false, null, loaded, fail, undefined, true, '.dds');
    });
    const [filter, type] = [Constants.TEXTURE_BILINEAR_SAMPLINGMODE, Constants.TEXTURETYPE_HALF_FLOAT];
    const taps = RawTexture.CreateRGBATexture(...table('babylon/taps.ktx2'), scene, false, false, filter, type);
    taps.wrapU = taps.wrapV = Constants.TEXTURE_CLAMP_ADDRESSMODE;
    const material = new PBRMaterial('metal', scene);
    Object.assign(material, { metallic: 1, roughness, albedoColor: new Color3(...F0), reflectionTexture: map });
    // The picture stays linear.
    material.imageProcessingConfiguration.applyByPostProcess = true;
    const [functions, lines] = pasted('babylon', 'reflectionSampler');
    const code = {
        CUSTOM_FRAGMENT_DEFINITIONS: `uniform sampler2D taps;\n${functions}
            vec3 turned(vec3 direction) {
                vec3 d = vec3(reflectionMatrix * vec4(direction, 0.0));
                #ifdef INVERTCUBICMAP
                d.y *= -1.0;
                #endif
                #ifdef REFLECTIONMAP_OPPOSITEZ
                d.z *= -1.0;
                #endif
                return d;
            }`,
        CUSTOM_FRAGMENT_BEFORE_FINALCOLORCOMPOSITION: `{
            vec3 n = turned(normalW), v = turned(viewDirectionW), f0 = clearcoatOut.specularEnvironmentR0;
            float n_dot_v = dot(n, v);
            vec2 dfg = vec2(environmentBrdf.y - environmentBrdf.x, environmentBrdf.x);
            ${lines}
            finalRadianceScaled = specular;
        }`,
    };
    class Pasted extends MaterialPluginBase {
        constructor() { super(material, 'Pasted', 200, {}, true, true); }
        getSamplers(samplers) { samplers.push('taps'); }
        bindForSubMesh(buffer) { buffer.setTexture('taps', taps); }
        getCustomCode(shader) { return shader === 'fragment' ? code : null; }
    }
    new Pasted();
    const sphere = CreateSphere('sphere', { diameter: 2, segments: 64 }, scene);
    sphere.material = material;
    const camera = new FreeCamera('camera', new Vector3(0, 0, DISTANCE), scene);
    camera.setTarget(Vector3.Zero());
    camera.fov = FOV * Math.PI / 180;
    const target = new RenderTargetTexture('target', SIZE, scene, { generateMipMaps: false, type: Constants.TEXTURETYPE_FLOAT });
    Object.assign(target, { renderList: [sphere], activeCamera: camera, clearColor: new Color4(0, 0, 0, 0) });
    scene.customRenderTargets.push(target);
    await scene.whenReadyAsync();
    scene.render();
    return target.readPixels();
};

const inPlayCanvas = async (roughness) => {
    const app = new pc.Application(canvas(), {});
    const device = app.graphicsDevice;
    const map = await new Promise((done, fail) => {
        const name = 'playcanvas/specular.dds';
        const asset = new pc.Asset(name, 'texture', { url: name, contents: bytes(name).buffer });
        asset.on('load', () => done(asset.resource));
        asset.on('error', fail);
        app.assets.add(asset);
        app.assets.load(asset);
    });
    const clamped = { mipmaps: false, addressU: pc.ADDRESS_CLAMP_TO_EDGE, addressV: pc.ADDRESS_CLAMP_TO_EDGE };
    const texture = (name, format) => {
        const [texels, width, height] = table(name);
        return new pc.Texture(device, { width, height, format, levels: [texels], ...clamped });
    };
    const material = new pc.StandardMaterial();
    Object.assign(material, { useMetalness: true, metalness: 1, gloss: 1 - roughness, cubeMap: map, useTonemap: false, shaderChunksVersion: '2.23' });
    material.diffuse.set(...F0.map((value) => value ** (1 / 2.2)));
    material.setParameter('taps', texture('playcanvas/taps.ktx2', pc.PIXELFORMAT_RGBA16F));
    material.setParameter('dfg_table', texture('playcanvas/dfg.ktx2', pc.PIXELFORMAT_RG16F));
    const [functions, lines] = pasted('playcanvas', 'texture_cubeMap');
    const chunks = material.getShaderChunks(pc.SHADERLANGUAGE_GLSL);
    chunks.set('reflectionCubePS', `
        uniform samplerCube texture_cubeMap;
        uniform sampler2D taps, dfg_table;
        uniform float material_reflectivity;
        ${functions}
        vec3 turned(vec3 direction) { return cubeMapProject(direction) * vec3(-1.0, 1.0, 1.0); }
        void addReflection(vec3 reflDir, float gloss) {
            vec3 n = turned(litArgs_worldNormal), v = turned(dViewDirW), f0 = litArgs_specularity;
            float n_dot_v = dot(n, v), roughness = 1.0 - gloss;
            vec2 dfg = textureLod(dfg_table, vec2(n_dot_v, roughness), 0.0).rg;
            ${lines}
            dReflection += vec4(specular, material_reflectivity);
        }`);
    // The lines have the Fresnel factor.
    chunks.set('fresnelSchlickPS', 'vec3 getFresnel(float cosTheta, float gloss, vec3 specularity) { return vec3(1.0); }');
    material.update();
    const sphere = new pc.Entity();
    const mesh = pc.Mesh.fromGeometry(device, new pc.SphereGeometry({ radius: 1, latitudeBands: 128, longitudeBands: 128 }));
    sphere.addComponent('render', { meshInstances: [new pc.MeshInstance(mesh, material)] });
    const colorBuffer = new pc.Texture(device, { width: SIZE, height: SIZE, format: pc.PIXELFORMAT_RGBA32F, ...clamped });
    const renderTarget = new pc.RenderTarget({ colorBuffer, depth: true });
    const camera = new pc.Entity();
    const linear = { gammaCorrection: pc.GAMMA_NONE, toneMapping: pc.TONEMAP_NONE };
    camera.addComponent('camera', { clearColor: new pc.Color(0, 0, 0, 0), fov: FOV, nearClip: 1, farClip: 9, renderTarget, ...linear });
    camera.setLocalPosition(0, 0, DISTANCE);
    app.root.addChild(sphere);
    app.root.addChild(camera);
    app.scene.ambientLight = new pc.Color(0, 0, 0);
    app.start();
    app.render();
    // Texture.read() waits for a fence, which virtual time does not signal.
    const picture = new Float32Array(4 * SIZE * SIZE);
    device.gl.bindFramebuffer(device.gl.FRAMEBUFFER, renderTarget.impl._glFrameBuffer);
    device.gl.readPixels(0, 0, SIZE, SIZE, device.gl.RGBA, device.gl.FLOAT, picture);
    app.destroy();
    return picture;
};

// The mean difference over the mean of ours, where both hit the sphere, and the largest; % of the mean. Pixels that the outline crosses
// are left out. Rows go up.
const difference = (found, own, place) => {
    const outline = SIZE / 2 * Math.tan(Math.asin(1 / DISTANCE)) / Math.tan(FOV * Math.PI / 360) - 1;
    let [sum, mean, worst, count] = [0, 0, 0, 0];
    for (let y = 0; y < SIZE; y++) for (let x = 0; x < SIZE; x++) {
        const [here, there] = [4 * (y * SIZE + x), 4 * (y * SIZE + place(x))];
        if (Math.hypot(x + 0.5 - SIZE / 2, y + 0.5 - SIZE / 2) > outline) continue;
        for (let i = 0; i < 3; i++) {
            const off = found[there + 3] === 1 && own[here + 3] === 1 ? Math.abs(found[there + i] - own[here + i]) : NaN;
            [sum, mean, worst, count] = [sum + off, mean + own[here + i], Math.max(worst, off), count + 1];
        }
    }
    return [sum / mean, worst * count / mean].map((value) => 100 * value);
};

export const spheres = async (say) => {
    for (const [name, folder, mapping, draw] of [['three.js', 'three', 'quadratic', inThree], ['Babylon.js', 'babylon', 'linear', inBabylon],
                                                 ['PlayCanvas', 'playcanvas', 'linear', inPlayCanvas]]) {
        for (const roughness of [0.3, 0.6]) {
            try {
                const late = new Promise((_, fail) => setTimeout(() => fail('no picture within 20 s'), 20000));
                const found = await Promise.race([draw(roughness), late]);
                const own = new EXRLoader().setDataType(THREE.FloatType).parse(bytes(`${mapping}-${roughness}.exr`).buffer).data;
                const [mean, worst] = difference(found, own, (x) => x);
                const [mirrored] = difference(found, own, (x) => SIZE - 1 - x);
                say(`${mean < 1 && mirrored > 20 ? 'PASSED' : 'FAILED'} ${name}: sphere of roughness ${roughness}: ${mean.toFixed(2)} % of the mean, ` +
                    `worst pixel ${worst.toFixed(1)} %; mirrored ${Math.round(mirrored)} %`);
            } catch (error) { say(`FAILED ${name}: ${error.message ?? error}`); }
        }
    }
};
