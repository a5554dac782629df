#!/bin/sh
# Runs `splitsum check-shader` on the lookups of three engines, before and after a repair: three.js and PlayCanvas from npm,
# Bevy from crates.io, each file pinned by its hash. None is kept. Needs npm, cargo and a network: skips with one line and
# exit status 77 without. Takes a minute after the build. scripts/test.sh runs it if CI is set.
#
#     sh scripts/check-shaders.sh
#
# Each adapter below calls the engine's own functions and replaces what they read: `prefiltered_radiance` its map,
# `albedo_pair` its table.
set -eu
[ $# -eq 0 ] || { echo "usage: sh scripts/check-shaders.sh" >&2; exit 2; }
root=$(cd "$(dirname "$0")/.." && pwd)
program=${SPLITSUM:-$root/target/release/splitsum}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

skip() {
    echo "skipped: $1"
    exit 77
}
from_npm() { # name, version
    npm pack --silent "$1@$2" >npm.log 2>&1 || skip "$1 $2 cannot be downloaded"
    mkdir "$1-$2"
    tar xzf "$1-$2.tgz" -C "$1-$2" --strip-components 1
}
from_crates() { # name, version
    cargo info --quiet "$1@$2" >/dev/null 2>cargo.log || skip "$1 $2 cannot be downloaded"
    ln -s "${CARGO_HOME:-$HOME/.cargo}"/registry/src/*/"$1-$2" "$1-$2"
}
pinned() { # hash, file
    echo "$1  $2" | sha256sum --check --status || { echo "FAILED: $2 is not the pinned file" >&2; exit 1; }
}
# The shader in a module of JavaScript: from the first line that ends with a backtick to the line of the closing one.
chunk() { # hash, file
    pinned "$1" "$2"
    sed -n '1,/^`;/p' "$2" | sed '1d;$d'
}
# A function that begins at the start of a line.
function_of() { # hash, file, name
    pinned "$1" "$2"
    sed -n "/^[a-z0-9]* $3(/,/^}/p" "$2"
}
failed=0
# The verdict must contain these words.
check() { # what, file, words
    verdict=$("$program" check-shader "$2" --entry ibl_radiance --masking correlated | sed -n 's/^Verdict: //p')
    case $verdict in
        *"$3"*) echo "$1: $verdict" ;;
        *) failed=1 && echo "FAILED $1: \"$verdict\" does not contain \"$3\"" ;;
    esac
}

command -v npm >/dev/null || skip "npm is missing"
from_npm three 0.170.0
from_npm three 0.187.0
from_npm playcanvas 2.23.3
from_crates bevy_pbr 0.15.3
from_crates bevy_pbr 0.16.1

# three.js draws the direction to the normal by alpha in r170, by alpha squared in r187. Its factors are a polynomial in r170,
# a table in r187.
chunks=src/renderers/shaders/ShaderChunk
{
    cat <<'GLSL'
#include "lib/split_sum.glsl"
#define USE_ENVMAP
#define ENVMAP_TYPE_CUBE_UV
#define envMap 0
#define saturate(x) clamp(x, 0.0, 1.0)
const mat3 envMapRotation = mat3(1.0);
const mat4 viewMatrix = mat4(1.0);
const float envMapIntensity = 1.0;
vec3 inverseTransformDirection(vec3 direction, mat4 matrix) { return direction; }
vec4 textureCubeUV(int map, vec3 direction, float roughness) { return vec4(prefiltered_radiance(direction, roughness), 1.0); }
GLSL
    chunk 8f60bbd44d7cfa639b603923e88fe17a1b3084f57e92218fdf8c5c495c15fded three-0.170.0/$chunks/envmap_physical_pars_fragment.glsl.js
    function_of 8228e12d6904efecff76ef21f217836bcf57100ab8c53326b74a8a6f273b04a8 three-0.170.0/$chunks/lights_physical_pars_fragment.glsl.js DFGApprox
    cat <<'GLSL'
vec3 ibl_radiance(vec3 n, vec3 v, float perceptual_roughness, vec3 f0) {
    vec2 factors = DFGApprox(n, v, perceptual_roughness);
    return getIBLRadiance(v, n, perceptual_roughness) * (f0 * factors.x + factors.y);
}
GLSL
} >three-before.glsl
{
    cat <<'GLSL'
#include "lib/split_sum.glsl"
#define USE_ENVMAP
#define ENVMAP_TYPE_PMREM
#define ENVMAP_MAX_LOD 1.0
#define roughnessToMip(roughness) (roughness)
#define textureLod(map, direction, level) vec4(prefiltered_radiance(direction, level), 1.0)
const mat3 envMapRotation = mat3(1.0);
const mat4 viewMatrix = mat4(1.0);
const float envMapIntensity = 1.0;
float pow4(float x) { return x * x * x * x; }
vec3 transformNormalByInverseViewMatrix(vec3 direction, mat4 matrix) { return direction; }
vec3 transformDirectionByInverseViewMatrix(vec3 direction, mat4 matrix) { return direction; }
GLSL
    chunk 8cc1ff6bcd8a05abc365054d5d3a23d2779be39b5bf9753eaa21e04ae21eaa78 three-0.187.0/$chunks/envmap_physical_pars_fragment.glsl.js
    cat <<'GLSL'
vec3 ibl_radiance(vec3 n, vec3 v, float perceptual_roughness, vec3 f0) {
    vec2 factors = albedo_pair(dfg, dot(n, v), perceptual_roughness * perceptual_roughness);
    return getIBLRadiance(v, n, perceptual_roughness) * (f0 * factors.x + factors.y);
}
GLSL
} >three-after.glsl

# Bevy looks along the mirror direction in 0.15 and along Frostbite's in 0.16.
pinned c285b64d501b422a89162fe6b43675d2d8a0335650229eda0276c28483e7d366 bevy_pbr-0.15.3/src/light_probe/environment_map.wgsl
grep -q 'var radiance_sample_dir = R;' bevy_pbr-0.15.3/src/light_probe/environment_map.wgsl
bevy() { # file, direction
    {
        function_of cdf1685f1e9f0205cf45860f2ed814bd07be83b7b96d1fa26b5918705a37ec0d bevy_pbr-0.16.1/src/render/pbr_lighting.wgsl F_AB
        function_of 862a5828a960e06592312ea9aaedbf7e1dbd38934264fbd4954bf3b0a9dbddd8 bevy_pbr-0.16.1/src/light_probe/environment_map.wgsl radiance_sample_direction
        cat <<WGSL
fn ibl_radiance(N: vec3<f32>, V: vec3<f32>, perceptual_roughness: f32, F0: vec3<f32>) -> vec3<f32> {
    let R = reflect(-V, N);
    let roughness = perceptual_roughness * perceptual_roughness;
    let factors = F_AB(perceptual_roughness, dot(N, V));
    return prefiltered_radiance(normalize($2), perceptual_roughness) * (F0 * factors.x + factors.y);
}
WGSL
    } >"$1"
}
bevy bevy-before.wgsl R
bevy bevy-after.wgsl 'radiance_sample_direction(N, R, roughness)'

# PlayCanvas looks along the mirror direction and reflects by Fresnel's factor at n.v. The repair is docs/paste.md's, without a
# table of taps.
chunks=playcanvas-2.23.3/build/playcanvas/src/scene/shader-lib/glsl/chunks/lit/frag
{
    cat <<'GLSL'
#include "lib/split_sum.glsl"
#include "lib/cap_direction.glsl"
#define saturate(x) clamp(x, 0.0, 1.0)
#define pow5 pow5_of_engine
vec3 dReflDirW;
GLSL
    chunk ee6aea956a97f8f40a4b1c0cd475736f4e9f4bb54a3eb8e632996fbc8b7d45dd $chunks/reflDir.js
    chunk 48c783e53b43b91d3311724c38c2ac7a7a8d6fed555499e4b51dae1ba2230728 $chunks/fresnelSchlick.js
} >playcanvas.glsl
{
    cat playcanvas.glsl
    cat <<'GLSL'
vec3 ibl_radiance(vec3 n, vec3 v, float perceptual_roughness, vec3 f0) {
    float gloss = 1.0 - perceptual_roughness;
    getReflDir(n, v, gloss, mat3(1.0));
    return prefiltered_radiance(dReflDirW, 1.0 - gloss) * getFresnel(dot(v, n), gloss, f0);
}
GLSL
} >playcanvas-before.glsl
{
    cat playcanvas.glsl
    cat <<'GLSL'
vec3 ibl_radiance(vec3 n, vec3 v, float perceptual_roughness, vec3 f0) {
    float n_dot_v = dot(n, v), alpha = perceptual_roughness * perceptual_roughness;
    vec2 factors = albedo_pair(dfg, n_dot_v, alpha);
    float share = factors.y / (dot(f0, vec3(1.0 / 3.0)) * factors.x + factors.y);
    vec3 direction = cap_direction(n, v, n_dot_v, alpha, share);
    return prefiltered_radiance(direction, perceptual_roughness) * (f0 * factors.x + factors.y);
}
GLSL
} >playcanvas-after.glsl

check "three.js r170" three-before.glsl "27.4 % too bright at alpha 1, f0 0.04; direction 11.4 degrees towards the normal at alpha 1, f0 0.04"
check "three.js r187" three-after.glsl "wrong: direction 19.7 degrees towards the mirror direction at alpha 0.5625, f0 1"
check "Bevy 0.15" bevy-before.wgsl "27.4 % too bright at alpha 1, f0 0.04; direction 60.7 degrees towards the mirror direction at alpha 1, f0 1"
check "Bevy 0.16" bevy-after.wgsl "27.4 % too bright at alpha 1, f0 0.04; direction 11.4 degrees towards the normal at alpha 1, f0 0.04"
check "PlayCanvas 2.23" playcanvas-before.glsl "121.9 % too bright at alpha 1, f0 1; direction 60.7 degrees towards the mirror direction at alpha 1, f0 1"
check "PlayCanvas 2.23, repaired" playcanvas-after.glsl "good: "
exit "$failed"
