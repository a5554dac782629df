// Samples of the sheen lobe in the live view.

#include "shade/lobe/sheen.glsl"

// One row of sample points (lib/sampling.glsl).
uniform sampler2D points;

vec3 sheen_direction(Lobe lobe, uint i) {
    vec4 point = texelFetch(points, ivec2(int(i), 0), 0);
    return lobe_sample(lobe, vec2(point.x, atan2_precise(point.z, point.y) / (2.0 * PI)));
}
