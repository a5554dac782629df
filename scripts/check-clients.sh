#!/bin/sh
# Checks the files of `splitsum bake --for` in other programs: ktx-parse, three.js, Babylon.js and PlayCanvas from npm, in a
# temporary folder, and Chromium. Each engine also draws a metal with the lines to paste (scripts/peers/spheres.js). Needs node,
# npm, a network for npm, chromium, and a Vulkan device for the pictures to compare with. Takes 42 s of CPU time.
# scripts/test.sh runs it if CI is set.
#
#     sh scripts/check-clients.sh [--bevy | --filament | --gain]
#
# With --filament, Filament draws the bake for it instead: a metal and a plastic under the marker and a studio, in Open3D
# (scripts/engines; a download of 0.5 GB). A mean must be within 0.5 % of `splitsum render` with Filament's lookup.
# With --gain, Babylon.js, PlayCanvas, F3D and SAPIEN draw metals under their own bakes and under ours (scripts/engines; a download of
# 1 GB): ours must be nearer to the engine's lookup with exact maps.
# With --bevy, Bevy also renders with our pair of maps and with the lines to paste, and filters our cube, on any Vulkan device. Its build takes 40 CPU
# minutes and 2 GB in target/bevy, its pictures a minute; BEVY_PEER names a program that is already built.
set -eu
case "$*" in
    "" | --bevy | --filament | --gain) ;;
    *) echo "usage: sh scripts/check-clients.sh [--bevy | --filament | --gain]" >&2; exit 2 ;;
esac
root=$(cd "$(dirname "$0")/.." && pwd)
program=${SPLITSUM:-$root/target/release/splitsum}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
if [ "$*" = --filament ]; then
    SPLITSUM=$program sh "$root/scripts/engines/run.sh" filament --out "$work" --map marker --map studio \
        --material metal,plastic --roughness 0.3,0.7
    "${ENGINES:-$root/target/engines}/tools/bin/python" "$root/scripts/engines/compare.py" "$work" --splitsum "$program" \
        --engine filament --check 0.5
    exit
fi
if [ "$*" = --gain ]; then
    for ours in '' --ours; do
        # shellcheck disable=SC2086 # a flag or nothing
        SPLITSUM=$program sh "$root/scripts/engines/run.sh" $ours babylon playcanvas f3d sapien --out "$work" --map marker --map studio \
            --material metal --roughness 0.3,0.7 --size 64
    done
    "${ENGINES:-$root/target/engines}/tools/bin/python" "$root/scripts/engines/gain.py" "$work" --splitsum "$program" --at-least 1
    exit
fi
cd "$work"

# Six lights of different colours on a floor, and a hot texel off every axis: u = 0.25 is +x, the centre +z.
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
npm install --silent --no-audit --no-fund --prefix . ktx-parse@2.0.0 three@0.187.0 @babylonjs/core@9.35.0 playcanvas@2.23.3 \
    esbuild@0.28.0 > npm.log 2>&1 &
npm=$!
(
    for engine in bevy khronos cesium; do
        "$program" bake marker.hdr --for $engine --set prefilter_size=64x64 --set dfg_size=8 --out $engine > /dev/null
    done
    "$program" bake marker.hdr --for khronos --format rgb9e5 --set prefilter_size=64x64 --set dfg_size=8 --out packed > /dev/null
) &
bakes=$!
for engine in three babylon playcanvas; do
    "$program" bake marker.hdr --for $engine --set prefilter_size=64x64 --out $engine > /dev/null
done
# The metal of spheres.js by `render`, with its own tables.
for mapping in linear quadratic; do
    for roughness in 0.3 0.6; do
        "$program" render --environment marker.hdr --method split-sum-two --diffuse none --masking correlated --level-mapping $mapping \
            --prefilter-size 64x64 --prefilter-level-count 4 --metallic 1 --albedo 1,0.5,0.2 --perceptual-roughness $roughness \
            --camera perspective --size 128x128 --out $mapping-$roughness.exr > /dev/null
    done
done
wait $bakes
wait $npm || { cat npm.log; echo "FAILED: npm"; exit 1; }

# KTX-Software's own validator, if it is installed. Our keys give warnings (7010), not errors.
if command -v ktx > ktx.log; then
    find . -name '*.ktx2' -exec sh -c 'ktx validate "$1" || echo "FAILED $1"' _ {} \; > ktx.log 2>&1
    if grep FAILED ktx.log; then cat ktx.log; exit 1; fi
    echo "PASSED ktx validate: $(find . -name '*.ktx2' | wc -l) files"
fi

cat > structure.mjs <<'JS'
import { readFileSync } from 'node:fs';
import { read } from 'ktx-parse';
let failed = 0;
const check = (name, ok, what) => { if (!ok) { failed = 1; console.log(`FAILED ktx-parse: ${name}: ${what}`); } };
const files = { 'bevy/specular.ktx2': [123, 6, 4, 2], 'bevy/diffuse.ktx2': [123, 6, 1, 2], 'khronos/specular.ktx2': [97, 6, 4, 0],
                'cesium/specular.ktx2': [97, 6, 4, 0], 'three/specular.ktx2': [97, 6, 4, 0], 'playcanvas/dfg.ktx2': [83, 1, 1, 0] };
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
console.log(failed ? 'FAILED ktx-parse' : 'PASSED ktx-parse: 6 files');
process.exit(failed);
JS
node structure.mjs

# three.js renders with each cube, one pixel a direction, through ktx-parse and its own zstd. Then each engine draws its spheres.
cp "$root/scripts/peers/spheres.js" .
cat > page.js <<'JS'
import * as THREE from 'three';
import { spheres } from './spheres.js';
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
    const bytes = Uint8Array.from(atob(FILES[`${engine}/specular.ktx2`]), (c) => c.charCodeAt(0));
    try {
        const cube = cubeOf(bytes);
        for (const [d, color] of colors) {
            const found = pixel(cube, lookup(d));
            const off = Math.max(...found.map((c, i) => Math.abs(c / color[i] - 1)));
            if (!(off < 1e-3)) said.push(`FAILED three.js: ${engine} ${d}: ${found} for ${color}`);
        }
    } catch (error) { said.push(`FAILED three.js: ${engine}: ${error.message ?? error}`); }
}
if (!said.length) said.push('PASSED three.js: 7 directions of 4 cubes');
await spheres((line) => said.push(line));
document.body.textContent = [...said, 'DONE'].join('\n');
JS
node --input-type=module - <<'JS'
import { build } from 'esbuild';
import { readdirSync, readFileSync, writeFileSync } from 'node:fs';
const names = ['bevy', 'khronos', 'cesium', 'packed'].map((engine) => `${engine}/specular.ktx2`);
for (const engine of ['three', 'babylon', 'playcanvas']) names.push(...readdirSync(engine).map((name) => `${engine}/${name}`));
names.push(...readdirSync('.').filter((name) => name.endsWith('.exr')));
const files = names.map((name) => [name, readFileSync(name).toString('base64')]);
const out = await build({ entryPoints: ['page.js'], bundle: true, format: 'esm', write: false, logLevel: 'error' });
const text = out.outputFiles[0].text.replaceAll('</script', '<\\/script');
writeFileSync('page.html', `<!doctype html><meta charset=utf-8><body><script>window.FILES = ${JSON.stringify(Object.fromEntries(files))}</script>` +
    `<script type=module>${text}</script>`);
JS
chromium --headless --no-sandbox --use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader --virtual-time-budget=60000 \
    --user-data-dir="$work/profile" --dump-dom "file://$work/page.html" 2> chromium.log | sed 's/<[^>]*>//g' | grep '^\(PASSED\|FAILED\|DONE$\)' > browser.log || true
grep -v DONE browser.log || true
if ! grep -q DONE browser.log || grep -q FAILED browser.log; then tail -5 chromium.log; echo "FAILED in the browser"; exit 1; fi
[ $# -gt 0 ] || exit 0

# Bevy, built without zstd, gets the same texels unpacked. Its DFG factors are a polynomial of n.v and r (Karis 2014, the fit for
# mobile devices) unless its feature dfg_lut is on: for this comparison they are our table.
bevy=${BEVY_PEER:-$root/target/bevy/release/bevy-peer}
[ -n "${BEVY_PEER:-}" ] || cargo build --release --manifest-path "$root/scripts/peers/bevy/Cargo.toml" --target-dir "$root/target/bevy"
"$program" bake marker.hdr --for bevy --format rgba16f --set prefilter_size=256x256 --out half > /dev/null
cat > plain.mjs <<'JS'
import { readFileSync, writeFileSync } from 'node:fs';
import { read, write } from 'ktx-parse';
import { DataUtils } from 'three';
import { ZSTDDecoder } from 'three/examples/jsm/libs/zstddec.module.js';
const zstd = new ZSTDDecoder();
await zstd.init();
for (const name of ['bevy/specular', 'bevy/diffuse', 'half/specular']) {
    const file = read(new Uint8Array(readFileSync(`${name}.ktx2`)));
    for (const level of file.levels) level.levelData = zstd.decode(level.levelData, level.uncompressedByteLength);
    writeFileSync(`${name}-plain.ktx2`, write({ ...file, supercompressionScheme: 0, keyValue: {} }));
}
const table = read(new Uint8Array(readFileSync('playcanvas/dfg.ktx2')));
const side = 128;
const texels = new Uint16Array(2 * side * side);
for (let i = 0; i < side * side; i++) {
    const [nv, r] = [i % side, Math.floor(i / side)].map((x) => (x + 0.5) / side);
    const a = Math.min((1 - r) ** 2, 2 ** (-9.28 * nv)) * (1 - r) + 0.0425 - 0.0275 * r;
    const factors = [-1.04 * a + 1.04 - 0.572 * r, 1.04 * a + 0.022 * r - 0.04];
    texels.set(factors.map((x) => DataUtils.toHalfFloat(Math.max(x, 5e-5))), 2 * i);
}
const levels = [{ levelData: new Uint8Array(texels.buffer), uncompressedByteLength: texels.byteLength }];
writeFileSync('polynomial.ktx2', write({ ...table, pixelWidth: side, pixelHeight: side, levels, keyValue: {} }));
JS
cat > pictures.mjs <<'JS'
import { readFileSync } from 'node:fs';
import { FloatType } from 'three';
import { EXRLoader } from 'three/examples/jsm/loaders/EXRLoader.js';
const [theirs, ours, what, most] = process.argv.slice(2);
const found = new Float32Array(new Uint8Array(readFileSync(theirs)).buffer);
const { data, width: n } = new EXRLoader().setDataType(FloatType).parse(new Uint8Array(readFileSync(ours)).buffer);
// Mean difference over the mean of ours, where both hit the sphere; the loader's rows go up.
const difference = (place) => {
    let [sum, mean] = [0, 0];
    for (let y = 0; y < n; y++) for (let x = 0; x < n; x++) {
        const [u, v] = place(x, y);
        const [here, there] = [4 * ((n - 1 - y) * n + x), 4 * (v * n + u)];
        if (data[here + 3] < 1 || found[there + 3] < 1) continue;
        for (let i = 0; i < 3; i++) { sum += Math.abs(found[there + i] - data[here + i]); mean += data[here + i]; }
    }
    return 100 * sum / mean;
};
const as = difference((x, y) => [x, y]);
const turned = [(x, y) => [n - 1 - x, y], (x, y) => [x, n - 1 - y], (x, y) => [n - 1 - x, n - 1 - y]].map(difference);
const passed = most ? as < most && Math.min(...turned) > 20 : as > 20;
const others = most ? `; mirrored or turned ${turned.map(Math.round).join(', ')} %` : '';
console.log(`${passed ? 'PASSED' : 'FAILED'} Bevy: ${what}: ${as.toFixed(2)} % of the mean${others}`);
process.exit(passed ? 0 : 1);
JS
node plain.mjs
draw() { # specular, diffuse, camera, roughness, what, largest difference in percent or nothing
    "$bevy" sphere "$1" "$2" 256 "$3" "$4" bevy.raw 2> bevy.log || { tail -5 bevy.log; echo "FAILED Bevy: $5"; exit 1; }
    "$program" render --environment marker.hdr --method split-sum-frostbite --diffuse irradiance-map --compensation fdez-aguera \
        --masking correlated --prefiltered 'file:bevy/specular.ktx2#bevy' --dfg 'file:polynomial.ktx2#bevy' --metallic 1 --albedo 1 \
        --perceptual-roughness "$4" --camera "$3" --size 256x256 --out ours.exr > /dev/null
    node pictures.mjs bevy.raw ours.exr "$5" "${6:-}"
}
for roughness in 0.2 0.5 0.8; do
    draw bevy/specular-plain.ktx2 bevy/diffuse-plain.ktx2 ortho $roughness "roughness $roughness" 2
done
draw bevy/specular-plain.ktx2 bevy/diffuse-plain.ktx2 perspective 0.5 'roughness 0.5 in perspective' 2
draw khronos/specular.ktx2 khronos/diffuse.ktx2 ortho 0.5 'the pair for the Khronos viewer must not fit'
for roughness in 0.3 0.6; do
    "$bevy" sphere bevy/specular-plain.ktx2 bevy/diffuse-plain.ktx2 128 perspective $roughness bevy.raw bevy 2> bevy.log ||
        { tail -5 bevy.log; echo "FAILED Bevy: pasted lines"; exit 1; }
    "$program" render --environment marker.hdr --method split-sum-two --diffuse none --masking correlated --level-mapping linear \
        --prefilter-size 64x64 --prefilter-level-count 4 --dfg 'file:polynomial.ktx2#bevy' --metallic 1 --albedo 1,0.5,0.2 \
        --perceptual-roughness $roughness --camera perspective --size 128x128 --out ours.exr > /dev/null
    node pictures.mjs bevy.raw ours.exr "sphere of roughness $roughness by the pasted lines" 1
done

# GeneratedEnvironmentMapLight: the levels that it makes from level 0.
"$bevy" filter half/specular-plain.ktx2 filtered.raw 2> bevy.log || { tail -5 bevy.log; echo "FAILED Bevy: filter"; exit 1; }
node --input-type=module - <<'JS'
import { readFileSync, writeFileSync } from 'node:fs';
import { read, write } from 'ktx-parse';
const file = read(new Uint8Array(readFileSync('half/specular-plain.ktx2')));
const texels = new Uint8Array(readFileSync('filtered.raw'));
const levels = [];
for (let side = file.pixelWidth, at = 0; side > 0; side >>= 1) {
    const bytes = 6 * 8 * side * side;
    levels.push({ levelData: texels.slice(at, at += bytes), uncompressedByteLength: bytes });
}
writeFileSync('filtered.ktx2', write({ ...file, levels, levelCount: levels.length }));
JS
echo "Bevy's GeneratedEnvironmentMapLight:"
"$program" check-bake specular=filtered.ktx2 --preset bevy --environment marker.hdr
