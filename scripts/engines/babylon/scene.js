// A sphere in Babylon.js under its own cube of the map, filtered on load, or under our `.env` (OURS).
import { FreeCamera } from '@babylonjs/core/Cameras/freeCamera.js';
import { Constants } from '@babylonjs/core/Engines/constants.js';
import { Engine } from '@babylonjs/core/Engines/engine.js';
import '@babylonjs/core/Engines/Extensions/engine.rawTexture.js';
import { CubeTexture } from '@babylonjs/core/Materials/Textures/cubeTexture.js';
import { HDRCubeTexture } from '@babylonjs/core/Materials/Textures/hdrCubeTexture.js';
import { RenderTargetTexture } from '@babylonjs/core/Materials/Textures/renderTargetTexture.js';
import '@babylonjs/core/Materials/Textures/Loaders/envTextureLoader.js';
import { Color4 } from '@babylonjs/core/Maths/math.color.js';
import { Vector3 } from '@babylonjs/core/Maths/math.vector.js';
import { Mesh } from '@babylonjs/core/Meshes/mesh.js';
import { VertexData } from '@babylonjs/core/Meshes/mesh.vertexData.js';
import { Scene } from '@babylonjs/core/scene.js';
import { DISTANCE, FOV, SIZE, mapUrl, sphereMesh } from '../page.js';

const SIDE = 128;
// Its shader cuts linear pictures at 30, so the light is dimmed and the picture brightened.
const DIMMED = 1 / 256;
// Its cubes of lat-long maps have -z in the centre, ours +z.
const ROTATION = Math.PI;

const canvas = Object.assign(document.createElement('canvas'), { width: SIZE, height: SIZE });
const scene = new Scene(new Engine(canvas, false));
scene.useRightHandedSystem = true;
const mesh = new Mesh('sphere', scene);
const data = new VertexData();
const { indices, ...arrays } = sphereMesh();
// Its front faces are clockwise.
Object.assign(data, { ...arrays, indices: indices.reverse() });
data.applyToMesh(mesh);
const camera = new FreeCamera('camera', new Vector3(0, 0, DISTANCE), scene);
camera.setTarget(Vector3.Zero());
Object.assign(camera, { fov: FOV, minZ: DISTANCE - 2, maxZ: DISTANCE + 2 });
const target = new RenderTargetTexture('target', SIZE, scene, { generateMipMaps: false, type: Constants.TEXTURETYPE_FLOAT });
Object.assign(target, { renderList: [mesh], activeCamera: camera, clearColor: new Color4(0, 0, 0, 0) });
scene.customRenderTargets.push(target);
scene.activeCamera = camera;

const light = (name) => new Promise((done, fail) => {
    if (OURS) {
        const texture = new CubeTexture(mapUrl(name), scene, null, false, null, () => done(texture), fail, undefined, true, '.env');
        Object.assign(texture, { rotationY: ROTATION, level: DIMMED });
        return;
    }
    const texture = new HDRCubeTexture(mapUrl(name), scene, SIDE, false, true, false, true, () => done(texture), fail);
    Object.assign(texture, { rotationY: ROTATION, level: DIMMED });
});

// The engine of page.js with this material of a sphere and a map.
export const withMaterial = (materialOf) => {
    const draw = async (sphere, map) => {
        const material = materialOf(scene, sphere, map);
        // The picture stays linear.
        material.imageProcessingConfiguration.applyByPostProcess = true;
        mesh.material = material;
        await scene.whenReadyAsync();
        scene.render();
        const rgba = await target.readPixels();
        material.dispose();
        return rgba.map((value) => value / DIMMED);
    };
    return { light, draw };
};
