#!/bin/sh
# @babylonjs/core 9.35.0 (npm): PBRMaterial of metallic 0 under a uniform white sky, in Chromium.
# Guess: the diffuse term gets what the specular term leaves, as in glTF's model: of a white albedo .96 facing the
#   viewer and .65 at n.v .2 if the ball is smooth, .99 facing the viewer if it is rough. Both terms together return
#   at most the light of the sky.
# Seen: .96 of the albedo, 1 - F0, at every roughness and every angle. A smooth white ball returns 1.27 times its
#   sky at n.v .2, one of roughness 1 returns .973 facing the viewer. useLegacySpecularEnergyConservation is on by
#   default. Switched off, the diffuse share is .69 at n.v .2 of a smooth ball, and every ball returns 1.
# Hurt: pale plastics, ceramics and painted walls glow at their rims under an environment; comparisons of glTF
#   viewers and path tracers, where white has another brightness by 2 % down and 27 % up.
# Avoid: material.brdf.useLegacySpecularEnergyConservation = false.
set -eu
t=$(mktemp -d)
trap 'rm -rf "$t"' EXIT
cd "$t"
browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome) || exit 77
command -v node >/dev/null || exit 77
npm install --silent --no-fund --no-audit --prefix . @babylonjs/core@9.35.0 esbuild@0.28.0 || exit 77
cat >page.js <<'J'
import { FreeCamera } from '@babylonjs/core/Cameras/freeCamera.js';
import { Constants } from '@babylonjs/core/Engines/constants.js';
import { Engine } from '@babylonjs/core/Engines/engine.js';
import '@babylonjs/core/Engines/Extensions/engine.rawTexture.js';
import { PBRMaterial } from '@babylonjs/core/Materials/PBR/pbrMaterial.js';
import { HDRCubeTexture } from '@babylonjs/core/Materials/Textures/hdrCubeTexture.js';
import { RenderTargetTexture } from '@babylonjs/core/Materials/Textures/renderTargetTexture.js';
import { Color3, Color4 } from '@babylonjs/core/Maths/math.color.js';
import { Vector3 } from '@babylonjs/core/Maths/math.vector.js';
import { CreateSphere } from '@babylonjs/core/Meshes/Builders/sphereBuilder.js';
import { Scene } from '@babylonjs/core/scene.js';
const [size, distance] = [200, 500];
const said = [`@babylonjs/core ${Engine.Version}`];
const scene = new Scene(new Engine(Object.assign(document.createElement('canvas'), { width: size, height: size }), false));
const mesh = CreateSphere('ball', { diameter: 2, segments: 64 }, scene);
// So far away that the view is the same everywhere; the picture shows the square of -1 to 1.
const camera = new FreeCamera('camera', new Vector3(0, 0, -distance), scene);
camera.setTarget(Vector3.Zero());
Object.assign(camera, { fov: 2 * Math.atan(1 / distance), minZ: distance - 2, maxZ: distance + 2 });
const target = new RenderTargetTexture('target', size, scene, { generateMipMaps: false, type: Constants.TEXTURETYPE_FLOAT });
Object.assign(target, { renderList: [mesh], activeCamera: camera, clearColor: new Color4(0, 0, 0, 0) });
scene.customRenderTargets.push(target);
scene.activeCamera = camera;
// A panorama of 8x4 texels of radiance 1, a run of eight equal bytes a plane.
const row = '\x02\x02\x00\x08\x88\x80\x88\x80\x88\x80\x88\x81';
const file = `#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n${row.repeat(4)}`;
const sky = await new Promise((done, fail) => {
    const texture = new HDRCubeTexture(`data:application/octet-stream;base64,${btoa(file)}`, scene, 32, false, true, false, true, () => done(texture), fail);
});
const picture = async (albedo, roughness, legacy) => {
    const material = new PBRMaterial('ball', scene);
    Object.assign(material, { metallic: 0, roughness, albedoColor: new Color3(albedo, albedo, albedo), reflectionTexture: sky });
    if (legacy !== undefined) material.brdf.useLegacySpecularEnergyConservation = legacy;
    material.imageProcessingConfiguration.applyByPostProcess = true;
    mesh.material = material;
    await scene.whenReadyAsync();
    scene.render();
    const pixels = await target.readPixels();
    return [1, 0.6, 0.4, 0.2].map((cosine) => pixels[4 * (size / 2 * size + Math.floor(size / 2 * (1 + Math.sqrt(1 - cosine * cosine))))]);
};
for (const [name, legacy] of [['default', undefined], ['legacy off', false]]) {
    for (const roughness of [0.1, 0.5, 1]) {
        const [white, black] = [await picture(1, roughness, legacy), await picture(0, roughness, legacy)];
        const share = white.map((value, at) => (value - black[at]).toFixed(3)).join(' ');
        said.push(`${name}, roughness ${roughness}: diffuse ${share}, whole ${white.map((value) => value.toFixed(3)).join(' ')}`);
    }
}
document.body.textContent = `\n${said.join('\n')}\nDONE\n`;
J
node_modules/.bin/esbuild page.js --bundle --format=esm --log-level=error --outfile=out.js
{ echo '<!doctype html><meta charset=utf-8><body><script type=module>'; sed 's|</script|<\\/script|g' out.js; echo '</script>'; } >page.html
nice -n 10 "$browser" --headless --no-sandbox --use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader \
    --virtual-time-budget=600000 --user-data-dir="$t/profile" --dump-dom "file://$t/page.html" 2>log | grep -E '^(@babylonjs/core|default, |legacy off, |DONE$)' >seen || true
grep -q DONE seen || { echo "the browser drew nothing"; exit 77; }
echo "at n.v 1, .6, .4, .2, as shares of the sky:"
grep -v DONE seen
[ "$(grep -c '^default.*diffuse 0.960 0.960 0.960 0.960,' seen)" = 3 ] || { echo "CHANGED: the diffuse share depends on angle or roughness"; exit 1; }
! grep -q '^legacy.*diffuse 0.960 0.960 0.960 0.960,' seen || { echo "CHANGED: the setting has no effect"; exit 1; }
echo "still so: the diffuse term is .96 of the albedo at every angle and roughness"
