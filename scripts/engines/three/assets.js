// The levels of three.js' PMREM of each map, a face a file, and its DFG table: roughness to the right, n.v down.
import * as THREE from 'three';
import { EXRLoader } from 'three/examples/jsm/loaders/EXRLoader.js';
import { DataUtils } from 'three';
import { getDFGLUT } from 'three/src/renderers/shaders/DFGLUTData.js';
import { mapUrl } from '../page.js';

const renderer = new THREE.WebGLRenderer();
const gl = renderer.getContext();
const FACES = ['px', 'nx', 'py', 'ny', 'pz', 'nz'];

const level = (texture, mip, face, side) => {
    const { __webglTexture } = renderer.properties.get(texture);
    const frame = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_CUBE_MAP_POSITIVE_X + face, __webglTexture, mip);
    const rgba = new Float32Array(4 * side * side);
    gl.readPixels(0, 0, side, side, gl.RGBA, gl.FLOAT, rgba);
    gl.deleteFramebuffer(frame);
    return Float32Array.from({ length: 3 * side * side }, (_, i) => rgba[4 * Math.floor(i / 3) + i % 3]);
};

export const assets = async (names, save) => {
    for (const name of names) {
        const source = await new EXRLoader().setDataType(THREE.FloatType).loadAsync(mapUrl(name));
        source.mapping = THREE.EquirectangularReflectionMapping;
        const target = new THREE.PMREMGenerator(renderer).fromEquirectangular(source);
        const count = Math.log2(target.width) - 2;
        for (let mip = 0; mip < count; mip++) for (let face = 0; face < 6; face++) {
            const side = target.width >> mip;
            // Rows of a cube's face go down.
            save(`${name}/m${mip}_${FACES[face]}`, side, side, level(target.texture, mip, face, side));
        }
    }
    const { data, width, height } = getDFGLUT().image;
    const table = Float32Array.from({ length: 3 * width * height }, (_, i) => i % 3 === 2 ? 0 : DataUtils.fromHalfFloat(data[2 * Math.floor(i / 3) + i % 3]));
    save('dfg', width, height, table);
};
