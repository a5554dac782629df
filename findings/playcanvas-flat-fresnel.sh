#!/bin/sh
# playcanvas 2.23.3 (npm): StandardMaterial of the metalness workflow under its own atlas, in Chromium.
# Guess: a smooth black dielectric under a uniform white sky shows Schlick's Fresnel factor: .04 facing
#   the viewer, .35 at n.v .2; a rough one reflects less, because facets shadow each other.
# Seen: .04 at every angle, at every roughness. The factor rises to (1 - roughness)^2 times the
#   largest channel of F0, not to 1, and the larger of that and F0 counts: nothing is left to rise for
#   a dielectric or a grey metal. Only the weaker channels of a coloured metal rise. There is no table
#   of masking either: a rough dielectric facing the viewer reflects 3.3 times its exact .012.
# Hurt: plastics, lacquer, wet floors and skin lose their bright rims; who compares glTF viewers or
#   authors materials in one of them sees another material in this one.
# Avoid: give the chunk fresnelSchlickPS a factor that rises to 1, and multiply by A and B of a table.
set -eu
t=$(mktemp -d)
trap 'rm -rf "$t"' EXIT
cd "$t"
browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome) || exit 77
command -v node >/dev/null || exit 77
npm install --silent --no-fund --no-audit --prefix . playcanvas@2.23.3 esbuild@0.28.0 || exit 77
cat >page.js <<'J'
import * as pc from 'playcanvas';
const [size, distance] = [200, 500];
const canvas = Object.assign(document.createElement('canvas'), { width: size, height: size });
const app = new pc.Application(canvas, {});
const device = app.graphicsDevice;
const plain = { mipmaps: false, addressU: pc.ADDRESS_CLAMP_TO_EDGE, addressV: pc.ADDRESS_CLAMP_TO_EDGE };
const colorBuffer = new pc.Texture(device, { width: size, height: size, format: pc.PIXELFORMAT_RGBA32F, ...plain });
const renderTarget = new pc.RenderTarget({ colorBuffer, depth: true });
const camera = new pc.Entity();
// So far away that the view is the same everywhere; the picture shows the square of -1 to 1.
camera.addComponent('camera', {
    fov: 360 / Math.PI * Math.atan(1 / distance), nearClip: distance - 2, farClip: distance + 2, renderTarget,
    layers: [pc.LAYERID_WORLD], gammaCorrection: pc.GAMMA_NONE, toneMapping: pc.TONEMAP_NONE,
});
camera.setLocalPosition(0, 0, distance);
const mesh = pc.Mesh.fromGeometry(device, new pc.SphereGeometry({ radius: 1, latitudeBands: 200, longitudeBands: 200 }));
const instance = new pc.MeshInstance(mesh, new pc.StandardMaterial());
const ball = new pc.Entity();
ball.addComponent('render', { meshInstances: [instance] });
app.root.addChild(ball);
app.root.addChild(camera);
app.scene.ambientLight = new pc.Color(0, 0, 0);
app.start();
const sky = new pc.Texture(device, { width: 64, height: 32, format: pc.PIXELFORMAT_RGBA32F, projection: pc.TEXTUREPROJECTION_EQUIRECT,
    levels: [new Float32Array(64 * 32 * 4).fill(1)], ...plain });
app.scene.envAtlas = pc.EnvLighting.generateAtlas(pc.EnvLighting.generateLightingSource(sky));
const said = [`playcanvas ${pc.version}`];
for (const roughness of [0.1, 0.5, 1]) {
    const material = new pc.StandardMaterial();
    Object.assign(material, { useMetalness: true, metalness: 0, gloss: 1 - roughness, useTonemap: false });
    material.diffuse.set(0, 0, 0);
    material.update();
    instance.material = material;
    app.render();
    const pixels = new Float32Array(4 * size * size);
    device.gl.bindFramebuffer(device.gl.FRAMEBUFFER, renderTarget.impl._glFrameBuffer);
    device.gl.readPixels(0, 0, size, size, device.gl.RGBA, device.gl.FLOAT, pixels);
    const at = (cosine) => pixels[4 * (size / 2 * size + Math.floor(size / 2 * (1 + Math.sqrt(1 - cosine * cosine))))];
    said.push(`roughness ${roughness}: ${[1, 0.6, 0.4, 0.2].map((cosine) => at(cosine).toFixed(4)).join(' ')}`);
}
document.body.textContent = `\n${said.join('\n')}\nDONE\n`;
J
node_modules/.bin/esbuild page.js --bundle --format=esm --log-level=error --outfile=out.js
{ echo '<!doctype html><meta charset=utf-8><body><script type=module>'; sed 's|</script|<\\/script|g' out.js; echo '</script>'; } >page.html
nice -n 10 "$browser" --headless --no-sandbox --use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader \
    --virtual-time-budget=60000 --user-data-dir="$t/profile" --dump-dom "file://$t/page.html" 2>log | grep -E '^(playcanvas|roughness|DONE)' >seen || true
grep -q DONE seen || { echo "the browser drew nothing"; exit 77; }
grep -v DONE seen
echo "expected .0400 .0498 .1146 .3546 at n.v 1, .6, .4, .2 for a smooth one, less for a rough one"
[ "$(grep -c ': 0.0400 0.0400 0.0400 0.0400$' seen)" = 3 ] || { echo "CHANGED: the factor depends on angle or roughness"; exit 1; }
echo "still so: .04 at every angle and roughness"
