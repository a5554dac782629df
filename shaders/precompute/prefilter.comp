// One invocation computes one texel of one level of the prefiltered map: the mean radiance of the
// lobe for n = v = r,
//     sum L w / sum w, h with density D(h) (n.h), w = n.l by default [Karis13 eq. 7 and listing 2],
// each lookup from the level at which a texel covers the sample's solid angle. Below ALPHA_MIN: the
// mirror, filtered to the texel's size. A dispatch adds the samples of its points: until the last
// of them the texel holds sum L w and, in a, sum w. Set 0: 0 the environment's filtered levels; 1
// the level (rgba32f), a layer a face; 2 sample points of this dispatch (lib/sampling.glsl).

#include "lib/prefilter.glsl"
#include "lib/image_groups.glsl"

layout(push_constant) uniform Push {
    PrefilterParams params;
};

layout(set = 0, binding = 0) uniform FILTERED_MAP environment;
layout(rgba32f, set = 0, binding = 1) uniform image2DArray level;
layout(std140, set = 0, binding = 2) uniform Points {
    vec4 points[POINTS_PER_DISPATCH];
};

vec4 sample_point(uint i) {
    return points[i];
}

void main() {
    uvec3 texel = gl_GlobalInvocationID + uvec3(0u, params.first_row, 0u);
    uvec2 size = uvec2(params.width, params.height);
    if (texel.x >= size.x || texel.y >= size.y) {
        return;
    }
    vec3 r = direction_from_texel(texel, vec2(0.5), vec2(size));
    vec4 sum;
    if (params.alpha < ALPHA_MIN) {
        sum = vec4(mirror_radiance(r, environment, params), 1.0);
    } else {
        sum = lobe_sum(r, environment, params);
        if (params.first_point > 0u) {
            sum += imageLoad(level, ivec3(texel));
        }
        if (params.first_point + params.point_count == params.sample_count) {
            // Every sample can fall below the horizon at large alpha and small counts.
            sum = vec4(sum.a > 0.0 ? sum.rgb / sum.a : mirror_radiance(r, environment, params), 1.0);
        }
    }
    imageStore(level, ivec3(texel), sum);
}
