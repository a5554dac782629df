// PlayCanvas: StandardMaterial under its own atlas of the map, or under ours (OURS).
import * as pc from 'playcanvas';
import { DISTANCE, FOV, SIZE, mapBytes, sphereMesh } from '../page.js';

const canvas = Object.assign(document.createElement('canvas'), { width: SIZE, height: SIZE });
const app = new pc.Application(canvas, {});
const device = app.graphicsDevice;
const clamped = { mipmaps: false, addressU: pc.ADDRESS_CLAMP_TO_EDGE, addressV: pc.ADDRESS_CLAMP_TO_EDGE };
const colorBuffer = new pc.Texture(device, { width: SIZE, height: SIZE, format: pc.PIXELFORMAT_RGBA32F, ...clamped });
const renderTarget = new pc.RenderTarget({ colorBuffer, depth: true });
const camera = new pc.Entity();
camera.addComponent('camera', {
    clearColor: new pc.Color(0, 0, 0, 0), fov: FOV * 180 / Math.PI, nearClip: DISTANCE - 2, farClip: DISTANCE + 2, renderTarget, layers: [pc.LAYERID_WORLD],
    gammaCorrection: pc.GAMMA_NONE, toneMapping: pc.TONEMAP_NONE,
});
camera.setLocalPosition(0, 0, DISTANCE);
app.root.addChild(camera);
app.scene.ambientLight = new pc.Color(0, 0, 0);
const geometry = new pc.Geometry();
Object.assign(geometry, sphereMesh());
const instance = new pc.MeshInstance(pc.Mesh.fromGeometry(device, geometry), new pc.StandardMaterial());
const ball = new pc.Entity();
ball.addComponent('render', { meshInstances: [instance] });
app.root.addChild(ball);
app.start();

const light = async (name) => {
    const map = await new Promise((done, fail) => {
        const options = { type: pc.TEXTURETYPE_RGBP, mipmaps: false, addressu: 'clamp', addressv: 'clamp' };
        const asset = OURS
            ? new pc.Asset(name, 'texture', { url: `${name}.png`, contents: mapBytes(name) }, options)
            : new pc.Asset(name, 'texture', { url: `${name}.hdr`, contents: mapBytes(name) });
        asset.on('load', () => done(asset.resource));
        asset.on('error', fail);
        app.assets.add(asset);
        app.assets.load(asset);
    });
    if (OURS) return map;
    map.projection = pc.TEXTUREPROJECTION_EQUIRECT;
    return pc.EnvLighting.generateAtlas(pc.EnvLighting.generateLightingSource(map));
};

const draw = (sphere, atlas) => {
    app.scene.envAtlas = atlas;
    app.scene.skyboxRotation = new pc.Quat().setFromEulerAngles(0, ROTATION, 0);
    const material = new pc.StandardMaterial();
    Object.assign(material, {
        useMetalness: true, metalness: sphere.metallic, gloss: 1 - sphere.roughness, useTonemap: false,
        clearCoat: sphere.coat ?? 0, clearCoatGloss: 1 - (sphere.coat_roughness ?? 0),
        enableGGXSpecular: !!sphere.anisotropy, anisotropyIntensity: sphere.anisotropy ?? 0,
    });
    // Its colours are encoded with gamma 2.2.
    material.diffuse.set(...sphere.base_color.map((value) => value ** (1 / 2.2)));
    material.update();
    instance.material = material;
    app.render();
    // Texture.read() waits for a fence, which virtual time does not signal.
    const rgba = new Float32Array(4 * SIZE * SIZE);
    device.gl.bindFramebuffer(device.gl.FRAMEBUFFER, renderTarget.impl._glFrameBuffer);
    device.gl.readPixels(0, 0, SIZE, SIZE, device.gl.RGBA, device.gl.FLOAT, rgba);
    material.destroy();
    return rgba;
};

const ROTATION = 0;

export const engine = { light, draw };
