// Adds the params.point_count samples from first_sample on of a method to the specular term of one
// pixel of the live view; a method without samples is one. The table may hold the points in any
// order: their sum is the same. The base is the first layer of a pixel.
#include "page/layers.glsl"
#include "selected/map_layout.glsl"

uniform FILTERED_MAP filtered_environment;
uniform FILTERED_MAP prefiltered;
uniform sampler2D one_tap;
uniform sampler2D two_taps;
uniform sampler2D four_taps;
// One row of sample points (lib/sampling.glsl).
uniform sampler2D points;
// The samples before first_sample, and the layers before this one.
uniform sampler2D so_far;
uniform uint first_sample;

out vec4 specular;

vec4 sample_point(uint i) {
    return texelFetch(points, ivec2(int(first_sample + i), 0), 0);
}

#include "selected/method.glsl"

void main() {
    bool is_first = first_sample == 0u && layer == LAYER_BASE;
    specular = is_first ? vec4(0.0) : texelFetch(so_far, ivec2(gl_FragCoord.xy), 0);
    Surface s;
    if (surface_here(s)) {
        vec3 share = layer_share(s);
        if (layer == LAYER_SHEEN) {
            // A lookup, which counts for these samples.
            share *= sheen_albedo_at(s.n_dot_v) * (float(params.point_count) / float(params.sample_count));
        }
        specular.rgb += share * (params.environment_scale * specular_radiance(surface_in_environment(s, params)));
    }
}
