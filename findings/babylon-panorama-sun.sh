#!/bin/sh
# @babylonjs/core 9.35.0 (npm): PanoramaToCubeMapTools, through which HDRCubeTexture goes.
# Guess: a 4096x2048 panorama becomes a cube of 128 by filtering, so a sun keeps its light
#   (within some %), and a turn by one source texel changes nothing.
# Seen: each cube texel takes one source texel, the nearest. Six suns of 4x4 texels (.35 degrees),
#   each a texel further along the diagonal: on a cube of 128 five are lost and one has 5 times its
#   light. (A cube of 256: 0 or 1.26.)
#   The option supersample (off unless asked for) brings it to .7 to 1.3; it does not mend it.
# Hurt: who loads an outdoor .hdr: the strength of the key light is decided by which texel the sun
#   lies on; a rotated or re-exported map lights the scene otherwise, and mips and SH inherit it.
# Avoid: shrink the panorama by an area filter to about four times the cube's size first.
set -eu
t=$(mktemp -d)
trap 'rm -rf "$t"' EXIT
cd "$t"
command -v node >/dev/null || exit 77
echo '{"type":"module"}' >package.json
npm install --silent --no-fund --no-audit @babylonjs/core@9.35.0 || exit 77
cat >run.mjs <<'J'
import fs from 'node:fs';
const root = '@babylonjs/core/Misc/HighDynamicRange/panoramaToCubemap.js';
const { PanoramaToCubeMapTools: tools } = await import(root);
const own = 'node_modules/@babylonjs/core/package.json';
console.log('@babylonjs/core', JSON.parse(fs.readFileSync(own)).version);
const w = 4096, h = 2048, sun = 4;
const map = new Float32Array(w * h * 3);
function ratio(size, shift, supersample) {
  let power = 0;
  map.fill(0);
  for (let j = 0; j < sun; j++) {
    const y = 820 + shift + j;
    const area = 2 * Math.PI / w * (Math.cos(Math.PI * y / h) - Math.cos(Math.PI * (y + 1) / h));
    for (let i = 0; i < sun; i++) {
      map.fill(1000, 3 * (y * w + 1228 + shift + i), 3 * (y * w + 1228 + shift + i) + 3);
      power += 1000 * area;
    }
  }
  const cube = tools.ConvertPanoramaToCubemap(map, w, h, size, supersample);
  let got = 0;
  for (const face of ['front', 'back', 'left', 'right', 'up', 'down'])
    for (let j = 0; j < size; j++)
      for (let i = 0; i < size; i++) {
        const u = 2 * (i + 0.5) / size - 1, v = 2 * (j + 0.5) / size - 1;
        const area = 4 / size / size / (1 + u * u + v * v) ** 1.5;
        got += cube[face][3 * (j * size + i)] * area;
      }
  return got / power;
}
const range = {};
for (const [size, supersample] of [[128, false], [128, true]]) {
  const all = [];
  for (let shift = 0; shift < 6; shift++) all.push(ratio(size, shift, supersample));
  range[`${size} ${supersample}`] = [Math.min(...all), Math.max(...all)];
  console.log(`cube ${size}${supersample ? ', supersample' : ''}: the sun's light over its own,`,
    'at 6 texels:', all.map(r => r.toFixed(2)).join(' '), '(expected .95 to 1.05)');
}
const lost = range['128 false'][0] < 0.01 && range['128 false'][1] > 2;
const still = range['128 true'][1] > 1.2 * range['128 true'][0];
if (!lost || !still) {
  console.log('CHANGED: the sun keeps its light through the conversion');
  process.exit(1);
}
console.log('still so: the sun is lost or multiplied by its position');
J
nice -n 10 node run.mjs
