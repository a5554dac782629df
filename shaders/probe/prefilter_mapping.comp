// One invocation evaluates lib/prefilter_mapping.glsl for one item.
// In: (perceptual_roughness, alpha, lod, level_count), (column, row, width, height), (n_dot_v, 0, 0, 0).
// Out: (alpha of the roughness, roughness of alpha, roughness of lod, lod of the roughness), (n_dot_v and alpha of the
// texel, DFG uv of n_dot_v and alpha).
// Set 0: 0 inputs, 3 vec4 an item; 1 outputs, 2 vec4 an item.

#include "lib/prefilter_mapping.glsl"
#include "probe/item.glsl"

void main() {
    uint item = gl_GlobalInvocationID.x;
    if (item >= params.count) {
        return;
    }
    vec4 a = inputs[item * 3u];
    uvec4 texel_size = uvec4(inputs[item * 3u + 1u]);
    uint level_count = uint(a.w);
    outputs[item * 2u] =
        vec4(alpha_from_perceptual_roughness(a.x), perceptual_roughness_from_alpha(a.y),
             perceptual_roughness_from_lod(a.z, level_count), lod_from_perceptual_roughness(a.x, level_count));
    outputs[item * 2u + 1u] =
        vec4(dfg_parameters_from_texel(texel_size.xy, texel_size.zw), dfg_uv(inputs[item * 3u + 2u].x, a.y, vec2(texel_size.zw)));
}
