// Adds the params.point_count samples from first_sample on of the sheen's integral to the reference
// of one pixel of the live view.
#include "page/layers.glsl"
#include "page/sheen_integral.glsl"
#include "selected/map_layout.glsl"

uniform FILTERED_MAP filtered_environment;
// The samples before first_sample, and the layers before this one.
uniform sampler2D so_far;
uniform uint first_sample;

out vec4 specular;

#include "lib/filtered_sample.glsl"

void main() {
    specular = texelFetch(so_far, ivec2(gl_FragCoord.xy), 0);
    Surface s;
    if (surface_here(s)) {
        vec3 share = layer_share(s);
        Lobe lobe = lobe_at(surface_in_environment(s, params), params);
        vec3 sum = vec3(0.0);
        for (uint i = 0u; i < params.point_count; ++i) {
            vec3 l = sheen_direction(lobe, first_sample + i);
            LobeValue kernel = lobe_eval(lobe, l);
            float weight = 1.0 / (float(params.sample_count) * kernel.pdf_l);
            sum += weight * kernel.value_cos * sampled_radiance(lobe.frame * l, weight);
        }
        specular.rgb += share * (params.environment_scale * sum);
    }
}
