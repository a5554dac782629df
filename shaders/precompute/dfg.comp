// One invocation computes one texel (A, B, 0, 1) of the DFG table: the albedo of the specular lobe
// is f0 A + B, n_dot_v along x, alpha along y. [Karis13 eq. 8] Set 0: 0 the table to write
// (rgba32f).

#include "lib/directional_albedo.glsl"
#include "generated/specialization/masking.glsl"
#include "lib/prefilter_mapping.glsl"
#include "lib/image_groups.glsl"

layout(push_constant) uniform Push {
    DfgParams params;
};

layout(rgba32f, set = 0, binding = 0) uniform writeonly image2D table;
void main() {
    uvec2 texel = gl_GlobalInvocationID.xy + uvec2(0u, params.first_row);
    uvec2 size = uvec2(params.width, params.height);
    if (texel.x >= size.x || texel.y >= size.y) {
        return;
    }
    vec2 at = dfg_parameters_from_texel(texel, size);
    vec2 a_b = directional_albedo(at.x, at.y, params.sample_count, MASKING).xy;
    imageStore(table, ivec2(texel), vec4(a_b, 0.0, 1.0));
}
