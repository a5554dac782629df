#!/bin/sh
# three 0.187.0 (npm): MeshStandardMaterial, in Chromium.
# Guess: a material's roughness decides its highlight: a sphere of roughness .1 under a narrow lamp
#   shows one profile of radiance, drawn 65 or 1025 pixels wide.
# Seen: the shader adds the largest change of the normal from pixel to pixel to the roughness, so
#   at 65 pixels the sphere facing the viewer has .13, and more towards its rim; the highlight's peak
#   is .73 of the peak at 1025, at 257 pixels .92. There is no setting for it; flat faces do not
#   have it.
# Hurt: thumbnails, previews of materials and comparisons of renderers by small pictures: smooth
#   objects look rough from far away, and an image test passes or fails by its resolution.
# Avoid: draw seven times as large and keep every seventh pixel, or set onBeforeCompile to remove
#   geometryRoughness.
set -eu
t=$(mktemp -d)
trap 'rm -rf "$t"' EXIT
cd "$t"
browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome) || exit 77
command -v node >/dev/null || exit 77
npm install --silent --no-fund --no-audit --prefix . three@0.187.0 esbuild@0.28.0 || exit 77
cat >page.js <<'J'
import * as THREE from 'three';
const renderer = new THREE.WebGLRenderer();
const [width, height] = [1024, 512];
// A lamp of 1 degree in the middle of a dim map, which three.js sees along +x.
const texels = new Float32Array(4 * width * height);
for (let y = 0; y < height; y++) for (let x = 0; x < width; x++) {
    const off = Math.hypot((x + 0.5 - width / 2) / width * 360, (y + 0.5 - height / 2) / height * 180);
    texels.fill(off < 1 ? 100 : 0.01, 4 * (y * width + x), 4 * (y * width + x) + 3);
}
const map = new THREE.DataTexture(texels, width, height, THREE.RGBAFormat, THREE.FloatType, THREE.EquirectangularReflectionMapping);
map.needsUpdate = true;
const scene = new THREE.Scene();
scene.environment = new THREE.PMREMGenerator(renderer).fromEquirectangular(map).texture;
const material = new THREE.MeshStandardMaterial({ metalness: 1, roughness: 0.1, color: 0xffffff });
scene.add(new THREE.Mesh(new THREE.SphereGeometry(1, 512, 256), material));
const camera = new THREE.OrthographicCamera(-1, 1, 1, -1, 1, 9);
camera.position.x = 5;
camera.lookAt(0, 0, 0);
const said = [`three ${THREE.REVISION}`];
for (const size of [65, 257, 1025]) {
    const target = new THREE.WebGLRenderTarget(size, size, { type: THREE.FloatType });
    renderer.setRenderTarget(target);
    renderer.render(scene, camera);
    const pixels = new Float32Array(4 * size * size);
    renderer.readRenderTargetPixels(target, 0, 0, size, size, pixels);
    // A pixel lies on the middle of the lamp at each of these sizes.
    let peak = 0;
    for (let i = 0; i < pixels.length; i += 4) peak = Math.max(peak, pixels[i]);
    said.push(`${size} pixels: peak ${peak.toFixed(1)}`);
}
document.body.textContent = `\n${said.join('\n')}\nDONE\n`;
J
node_modules/.bin/esbuild page.js --bundle --format=esm --log-level=error --outfile=out.js
{ echo '<!doctype html><meta charset=utf-8><body><script type=module>'; sed 's|</script|<\\/script|g' out.js; echo '</script>'; } >page.html
nice -n 10 "$browser" --headless --no-sandbox --use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader \
    --virtual-time-budget=60000 --user-data-dir="$t/profile" --dump-dom "file://$t/page.html" 2>log | grep -E '^(three|[0-9]+ pixels|DONE)' >seen || true
grep -q DONE seen || { echo "the browser drew nothing"; exit 77; }
grep -v DONE seen
awk '/ pixels/ { peak[$1] = $4 } END { exit !(peak[65] < 0.8 * peak[1025]) }' seen ||
    { echo "CHANGED: the highlight does not depend on the size of the picture"; exit 1; }
awk '/ pixels/ { peak[$1] = $4 } END { printf "still so: the peak at 65 pixels is %.2f of the peak at 1025\n", peak[65] / peak[1025] }' seen
