#!/bin/sh
# Checks what `splitsum bake --for` writes by programs of others: ktx-parse and three.js from npm, in a temporary folder, and Chromium.
# Needs node, npm, a network for npm, and chromium. About 30 s beside the build. Not part of scripts/test.sh.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
program=${SPLITSUM:-$root/target/release/splitsum}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# Six lights of their own colours on a floor, and a hot texel off every axis: u = 0.25 is +x, the centre +z.
node --input-type=module - <<'JS'
import { writeFileSync } from 'node:fs';
const [w, h] = [256, 128];
const lights = [[[1, 0, 0], [8, 1, 1]], [[-1, 0, 0], [1, 8, 8]], [[0, 1, 0], [1, 8, 1]],
                [[0, -1, 0], [8, 1, 8]], [[0, 0, 1], [1, 1, 8]], [[0, 0, -1], [8, 8, 1]]];
const hot = [0.35, 0.6, 0.72].map((x, _, a) => x / Math.hypot(...a));
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const bytes = Buffer.alloc(w * h * 4);
for (let y = 0; y < h; y++) for (let x = 0; x < w; x++) {
    const [phi, theta] = [2 * Math.PI * ((x + 0.5) / w - 0.5), Math.PI * (y + 0.5) / h];
    const d = [-Math.sin(phi) * Math.sin(theta), Math.cos(theta), Math.cos(phi) * Math.sin(theta)];
    const rgb = [0.125, 0.125, 0.125];
    for (const [axis, color] of lights) if (dot(d, axis) > 0.9) color.forEach((c, i) => { rgb[i] = c; });
    if (dot(d, hot) > 0.99) rgb.fill(60);
    const e = Math.ceil(Math.log2(Math.max(...rgb))) + 1;
    rgb.forEach((c, i) => { bytes[4 * (y * w + x) + i] = Math.min(255, Math.floor(c * 2 ** (8 - e))); });
    bytes[4 * (y * w + x) + 3] = e + 128;
}
writeFileSync('marker.hdr', Buffer.concat([Buffer.from(`#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y ${h} +X ${w}\n`), bytes]));
JS
for engine in bevy khronos cesium filament raw; do
    "$program" bake marker.hdr --for $engine --set prefilter_size=64x64 --set dfg_size=8 --out $engine > /dev/null
done
"$program" bake marker.hdr --for khronos --format rgb9e5 --set prefilter_size=64x64 --set dfg_size=8 --out packed > /dev/null

npm install --silent --no-audit --no-fund --prefix . ktx-parse@2.0.0 three@0.187.0 esbuild@0.28.0 > npm.log 2>&1 || { cat npm.log; echo "FAILED: npm"; exit 1; }

cat > structure.mjs <<'JS'
import { readFileSync } from 'node:fs';
import { read } from 'ktx-parse';
let failed = 0;
const check = (name, ok, what) => { if (!ok) { failed = 1; console.log(`FAILED ktx-parse: ${name}: ${what}`); } };
const files = { 'bevy/specular.ktx2': [123, 6, 5, 2], 'bevy/diffuse.ktx2': [123, 6, 1, 2], 'khronos/specular.ktx2': [97, 6, 5, 0],
                'cesium/specular.ktx2': [97, 6, 5, 0], 'raw/dfg.ktx2': [83, 1, 1, 0] };
for (const [name, [format, faces, levels, packed]] of Object.entries(files)) {
    const file = read(readFileSync(name));
    check(name, file.vkFormat === format && file.faceCount === faces && file.levelCount === levels && file.supercompressionScheme === packed,
          JSON.stringify([file.vkFormat, file.faceCount, file.levelCount, file.supercompressionScheme]));
    const bytes = { 97: 8, 123: 4, 83: 4 }[format];
    file.levels.forEach((level, k) => {
        const size = faces * Math.max(file.pixelWidth >> k, 1) ** 2 * bytes;
        check(name, level.uncompressedByteLength === size && (packed || level.levelData.byteLength === size), `level ${k}`);
    });
    check(name, file.dataFormatDescriptor[0].bytesPlane[0] === bytes && /^splitsum /.test(file.keyValue.KTXwriter), 'descriptor or writer');
    check(name, file.keyValue['splitsum.source_hash'].length >= 64, 'source_hash');
}
console.log(failed ? 'FAILED ktx-parse' : 'PASSED ktx-parse: 5 files');
process.exit(failed);
JS
node structure.mjs

# three.js renders with each cube, one pixel a direction, through ktx-parse and its own zstd: its KTX2Loader has no float cubes (r187).
cat > page.js <<'JS'
import * as THREE from 'three';
import { read } from 'ktx-parse';
import { ZSTDDecoder } from 'three/examples/jsm/libs/zstddec.module.js';
const said = [];
const renderer = new THREE.WebGLRenderer();
const zstd = new ZSTDDecoder();
await zstd.init();
const cubeOf = (bytes) => {
    const file = read(bytes);
    const { levelData, uncompressedByteLength } = file.levels[0];
    const data = file.supercompressionScheme === 2 ? zstd.decode(levelData, uncompressedByteLength) : levelData;
    const [side, face] = [file.pixelWidth, uncompressedByteLength / 6];
    const isHalf = file.vkFormat === 97;
    const image = (i) => {
        const part = data.slice(i * face, (i + 1) * face).buffer;
        const format = isHalf ? THREE.RGBAFormat : THREE.RGBFormat;
        const type = isHalf ? THREE.HalfFloatType : THREE.UnsignedInt5999Type;
        return new THREE.DataTexture(isHalf ? new Uint16Array(part) : new Uint32Array(part), side, side, format, type);
    };
    const cube = new THREE.CubeTexture([0, 1, 2, 3, 4, 5].map(image));
    Object.assign(cube, { format: cube.image[0].format, type: cube.image[0].type, minFilter: THREE.LinearFilter, generateMipmaps: false });
    cube.needsUpdate = true;
    return cube;
};
const target = new THREE.WebGLRenderTarget(1, 1, { type: THREE.FloatType });
const camera = new THREE.OrthographicCamera(-1, 1, 1, -1, -1, 1);
const pixel = (cube, d) => {
    const material = new THREE.ShaderMaterial({
        uniforms: { cube: { value: cube }, d: { value: new THREE.Vector3(...d) } },
        vertexShader: 'void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }',
        fragmentShader: 'uniform samplerCube cube; uniform vec3 d; void main() { gl_FragColor = texture(cube, d); }',
    });
    const scene = new THREE.Scene();
    scene.add(new THREE.Mesh(new THREE.PlaneGeometry(2, 2), material));
    renderer.setRenderTarget(target);
    renderer.render(scene, camera);
    const out = new Float32Array(4);
    renderer.readRenderTargetPixels(target, 0, 0, 1, 1, out);
    return [...out].slice(0, 3);
};
const colors = [[[1, 0, 0], [8, 1, 1]], [[-1, 0, 0], [1, 8, 8]], [[0, 1, 0], [1, 8, 1]],
                [[0, -1, 0], [8, 1, 8]], [[0, 0, 1], [1, 1, 8]], [[0, 0, -1], [8, 8, 1]], [[0.35, 0.6, 0.72], [60, 60, 60]]];
// Where the shader of each engine looks a direction of the world up.
const lookups = { bevy: ([x, y, z]) => [x, y, -z], khronos: ([x, y, z]) => [z, y, -x], cesium: (d) => d, packed: ([x, y, z]) => [z, y, -x] };
for (const [engine, lookup] of Object.entries(lookups)) {
    const bytes = Uint8Array.from(atob(FILES[engine]), (c) => c.charCodeAt(0));
    try {
        const cube = cubeOf(bytes);
        for (const [d, color] of colors) {
            const found = pixel(cube, lookup(d));
            const off = Math.max(...found.map((c, i) => Math.abs(c / color[i] - 1)));
            if (!(off < 1e-3)) said.push(`FAILED three.js: ${engine} ${d}: ${found} for ${color}`);
        }
    } catch (error) { said.push(`FAILED three.js: ${engine}: ${error.message ?? error}`); }
}
document.title = 'done';
document.body.textContent = said.length ? said.join('\n') : 'PASSED three.js: 7 directions of 4 cubes';
JS
node --input-type=module - <<'JS'
import { build } from 'esbuild';
import { readFileSync, writeFileSync } from 'node:fs';
const files = ['bevy', 'khronos', 'cesium', 'packed'].map((e) => [e, readFileSync(`${e}/specular.ktx2`).toString('base64')]);
const out = await build({ entryPoints: ['page.js'], bundle: true, format: 'esm', write: false, logLevel: 'error' });
const text = out.outputFiles[0].text.replaceAll('</script', '<\\/script');
writeFileSync('page.html', `<!doctype html><meta charset=utf-8><body><script>window.FILES = ${JSON.stringify(Object.fromEntries(files))}</script>` +
    `<script type=module>${text}</script>`);
JS
chromium --headless --no-sandbox --use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader --virtual-time-budget=60000 \
    --user-data-dir="$work/profile" --dump-dom "file://$work/page.html" 2> chromium.log | sed -n 's/<[^>]*>//g; /PASSED\|FAILED/p' | grep -o '\(PASSED\|FAILED\).*' > three.log || true
cat three.log
grep -q '^PASSED three.js' three.log || { tail -5 chromium.log; echo "FAILED three.js"; exit 1; }
