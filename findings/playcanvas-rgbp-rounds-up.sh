#!/bin/sh
# playcanvas 2.23.3 (npm): EnvLighting.generateAtlas, the prefiltered atlas in RGBP, in Chromium.
# Guess: the largest channel of a uniform sky comes back within its 8 bits: its root is stored over a
#   factor of 1 to 8 in steps of 1/255, so it is right within .8 %, and colours keep their hue.
# Seen: every sky above 1 is too dark in its largest channel, by up to 5 %: a grey of 1.05 becomes
#   1.00, of 1.62 becomes 1.56. The scale is rounded up to a byte, so the factor is below the largest
#   root, which is cut at it. The other channels are right: amber (1.05 .5 .2) turns (1.00 .5 .2).
# Hurt: who lights a scene brighter than 1 or compares its exposure with another engine; lamps and
#   skies lose light and turn paler the nearer they are to the next step.
# Avoid: floor in place of ceil in encodeRGBP (encode.js), or an atlas that another program wrote.
set -eu
t=$(mktemp -d)
trap 'rm -rf "$t"' EXIT
cd "$t"
browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome) || exit 77
command -v node >/dev/null || exit 77
npm install --silent --no-fund --no-audit --prefix . playcanvas@2.23.3 esbuild@0.28.0 || exit 77
cat >page.js <<'J'
import * as pc from 'playcanvas';
const { graphicsDevice: device } = new pc.Application(document.createElement('canvas'), {});
const skies = [[0.5, 0.5, 0.5], [1.05, 1.05, 1.05], [1.05, 0.5, 0.2], [1.62, 1.62, 1.62], [10.5, 10.5, 10.5], [40, 20, 5]];
const said = [`playcanvas ${pc.version}`];
for (const [number, sky] of skies.entries()) {
    const texels = new Float32Array(64 * 32 * 4);
    for (let i = 0; i < texels.length; i += 4) texels.set([...sky, 1], i);
    const source = new pc.Texture(device, {
        width: 64, height: 32, format: pc.PIXELFORMAT_RGBA32F, projection: pc.TEXTUREPROJECTION_EQUIRECT, mipmaps: false,
        addressU: pc.ADDRESS_CLAMP_TO_EDGE, addressV: pc.ADDRESS_CLAMP_TO_EDGE, levels: [texels],
    });
    const atlas = pc.EnvLighting.generateAtlas(pc.EnvLighting.generateLightingSource(source));
    // The middle of the level of roughness 1/5; decodeRGBP of decode.js.
    const { gl } = device;
    gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, atlas.impl._glTexture, 0);
    const texel = new Uint8Array(4);
    gl.readPixels(128, 320, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, texel);
    const [r, g, b, a] = texel;
    const found = [r, g, b].map((code) => (code / 255 * (8 - 7 * a / 255)) ** 2);
    said.push(`sky ${number}: ${sky.join(' ')} becomes ${found.map((x) => x.toFixed(3)).join(' ')}, ratios ${found.map((x, k) => (x / sky[k]).toFixed(3)).join(' ')}`);
}
said.push('DONE');
document.body.textContent = `\n${said.join('\n')}\n`;
J
node_modules/.bin/esbuild page.js --bundle --format=esm --log-level=error --outfile=out.js
{ echo '<!doctype html><meta charset=utf-8><body><script type=module>'; sed 's|</script|<\\/script|g' out.js; echo '</script>'; } >page.html
nice -n 10 "$browser" --headless --no-sandbox --use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader \
    --virtual-time-budget=60000 --user-data-dir="$t/profile" --dump-dom "file://$t/page.html" 2>log | grep -E '^(playcanvas|sky|DONE)' >seen || true
grep -q DONE seen || { echo "the browser drew nothing"; exit 77; }
grep -v DONE seen
echo "expected ratios from .992 to 1.008 in the largest channel"
awk '/^sky 1:/ { grey = $(NF - 2) < .96 } /^sky 2:/ { amber = $(NF - 2) < .96 && $(NF - 1) > .99 } /^sky 0:/ { dark = $(NF - 2) > .99 }
    END { exit !(grey && amber && dark) }' seen || { echo "CHANGED: bright skies keep their light"; exit 1; }
echo "still so: the largest channel of a bright sky is cut"
