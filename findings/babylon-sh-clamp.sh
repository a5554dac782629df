#!/bin/sh
# @babylonjs/core 9.35.0 (npm): CubeMapToSphericalPolynomialTools, the diffuse light of HDR maps.
# Guess: irradiance is linear: a sun ten times as bright gives ten times its diffuse light, and a
#   cube of half the resolution (box-filtered, the same light) gives the same.
# Seen: every channel is cut at 4096 before the sum. A clear-sky sun of 100000 gives 4 % of its
#   light; an orange one turns white; and since a filter spreads the sun, the coarser cube gives
#   up to 4 times the diffuse light of the finer one from the same map. No message.
#   A pull request of 2023 (13809) made the limit a static member marked internal; it stayed on.
# Hurt: outdoor maps: the sky dominates, shadows and lit sides lose contrast, scenes lit by HDR
#   suns look overcast, and the size argument of the texture changes the exposure.
# Avoid: set MAX_HDRI_VALUE (and mind SH ringing), or take the sun out as a directional light.
set -eu
t=$(mktemp -d)
trap 'rm -rf "$t"' EXIT
cd "$t"
command -v node >/dev/null || exit 77
echo '{"type":"module"}' >package.json
npm install --silent --no-fund --no-audit @babylonjs/core@9.35.0 || exit 77
cat >run.mjs <<'J'
import fs from 'node:fs';
const root = '@babylonjs/core/Misc/HighDynamicRange/cubemapToSphericalPolynomial.js';
const { CubeMapToSphericalPolynomialTools: tools } = await import(root);
const own = 'node_modules/@babylonjs/core/package.json';
console.log('@babylonjs/core', JSON.parse(fs.readFileSync(own)).version);
// A sun of wide x wide texels at the middle of the face +Y, nothing else; light at its normal.
function light(size, wide, rgb) {
  const cube = { size, format: 4, type: 1, gammaSpace: false };
  for (const face of ['front', 'back', 'left', 'right', 'up', 'down'])
    cube[face] = new Float32Array(size * size * 3);
  for (let j = 0; j < wide; j++)
    for (let i = 0; i < wide; i++)
      cube.up.set(rgb, 3 * ((size / 2 + j) * size + size / 2 + i));
  const p = tools.ConvertCubeMapToSphericalPolynomial(cube);
  return ['x', 'y', 'z'].map(k => (p.xx[k] + p.yy[k] + p.zz[k]) / 3);
}
const dim = light(256, 2, [4000, 4000, 4000])[0];
const bright = light(256, 2, [100000, 100000, 100000])[0];
const share = bright / dim / 25;
console.log(`sun of 100000 over sun of 4000: x ${(bright / dim).toFixed(3)} (expected x 25.000)`);
const tint = light(256, 2, [100000, 60000, 30000]);
console.log('sun 100 : 60 : 30 gives', tint.map(v => (100 * v / tint[0]).toFixed(1)).join(' : '));
const fine = light(256, 2, [16384, 16384, 16384])[0];
const coarse = light(128, 2, [4096, 4096, 4096])[0];
console.log(`the same light, cube of 128 over 256: x ${(coarse / fine).toFixed(3)} (expected 1)`);
tools.MAX_HDRI_VALUE = 1e9;
const free = light(256, 2, [100000, 100000, 100000])[0] / dim;
console.log(`with the limit raised: x ${free.toFixed(3)}`);
if (share > 0.06 || tint[2] / tint[0] < 0.99 || coarse / fine < 3 || Math.abs(free - 25) > 0.01) {
  console.log('CHANGED: the diffuse light is no longer cut at 4096');
  process.exit(1);
}
console.log(`still so: a sun of 100000 keeps ${(100 * share).toFixed(1)} % of its diffuse light`);
J
nice -n 10 node run.mjs
