#!/bin/sh
# @babylonjs/core 9.35.0 (npm): PBRMaterial in a floating-point target, in Chromium.
# Guess: with image processing left to a post-process, a 32-bit target holds linear radiance: a
#   mirror under a uniform sky of L shows L.
# Seen: every value above 30 is 30, in each channel: a sky of (120, 60, 15) becomes (30, 30, 15). The
#   shader clamps a linear colour to 0..30 (pbrBlockImageProcessing); there is no setting for it.
# Hurt: bloom, exposure and screenshots of HDR scenes: suns, lamps and their reflections all have
#   the same brightness and turn white or lose their hue; pictures compared with other renderers.
# Avoid: dim the light (texture.level) so that nothing exceeds 30, and raise the exposure.
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
import { RawCubeTexture } from '@babylonjs/core/Materials/Textures/rawCubeTexture.js';
import { RenderTargetTexture } from '@babylonjs/core/Materials/Textures/renderTargetTexture.js';
import { Color3 } from '@babylonjs/core/Maths/math.color.js';
import { Vector3 } from '@babylonjs/core/Maths/math.vector.js';
import { CreateSphere } from '@babylonjs/core/Meshes/Builders/sphereBuilder.js';
import { Scene } from '@babylonjs/core/scene.js';
const size = 65;
const said = [`@babylonjs/core ${Engine.Version}`];
const scene = new Scene(new Engine(Object.assign(document.createElement('canvas'), { width: size, height: size }), false));
const mesh = CreateSphere('ball', { diameter: 2, segments: 32 }, scene);
const camera = new FreeCamera('camera', new Vector3(0, 0, -4), scene);
camera.setTarget(Vector3.Zero());
const target = new RenderTargetTexture('target', size, scene, { generateMipMaps: false, type: Constants.TEXTURETYPE_FLOAT });
Object.assign(target, { renderList: [mesh], activeCamera: camera });
scene.customRenderTargets.push(target);
for (const radiance of [[12, 6, 1.5], [120, 60, 15]]) {
    const face = new Float32Array(4 * 16);
    for (let i = 0; i < 16; i++) face.set([...radiance, 1], 4 * i);
    const sky = new RawCubeTexture(scene, Array(6).fill(face), 4, Constants.TEXTUREFORMAT_RGBA, Constants.TEXTURETYPE_FLOAT, false);
    sky.gammaSpace = false;
    const material = new PBRMaterial('mirror', scene);
    Object.assign(material, { metallic: 1, roughness: 0, albedoColor: new Color3(1, 1, 1), reflectionTexture: sky });
    material.imageProcessingConfiguration.applyByPostProcess = true;
    mesh.material = material;
    await scene.whenReadyAsync();
    scene.render();
    const pixels = await target.readPixels();
    const middle = 4 * (32 * size + 32);
    said.push(`sky ${radiance.join(' ')}: mirror ${[...pixels.slice(middle, middle + 3)].map((value) => value.toFixed(2)).join(' ')}`);
}
document.body.textContent = `\n${said.join('\n')}\nDONE\n`;
J
node_modules/.bin/esbuild page.js --bundle --format=esm --log-level=error --outfile=out.js
{ echo '<!doctype html><meta charset=utf-8><body><script type=module>'; sed 's|</script|<\\/script|g' out.js; echo '</script>'; } >page.html
nice -n 10 "$browser" --headless --no-sandbox --use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader \
    --virtual-time-budget=60000 --user-data-dir="$t/profile" --dump-dom "file://$t/page.html" 2>log | grep -E '^(@babylonjs|sky|DONE)' >seen || true
grep -q DONE seen || { echo "the browser drew nothing"; exit 77; }
grep -v DONE seen
grep -q '^sky 12 6 1.5: mirror 1[12].* [56].* 1.[45]' seen || { echo "CHANGED: the dim sky is not shown as it is"; exit 1; }
grep -q '^sky 120 60 15: mirror 30.00 30.00 1[45]' seen || { echo "CHANGED: a linear colour is no longer cut at 30"; exit 1; }
echo "still so: linear colours end at 30"
