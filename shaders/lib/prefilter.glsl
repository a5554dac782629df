// The mean radiance of a specular lobe for n = v = r: the first factor of the split sum.

#include "generated/layout.glsl"
#include "lib/filtering.glsl"
#include "lib/frame.glsl"
#include "lib/prefilter_weight.glsl"
#include "lib/sampling.glsl"
#include "selected/brdf.glsl"
#include "selected/map_layout.glsl"

// Radiance of the mirror direction, filtered from the source's texels to the written ones.
vec3 mirror_radiance(vec3 r, FILTERED_MAP environment, PrefilterParams params) {
    float source_texels = float(params.source_width) * float(params.source_height);
    float lod = 0.5 * log2(source_texels / (float(params.width) * float(params.height)));
    return map_radiance(environment, map_place(r), max(lod, 0.0));
}

// (sum L w, sum w) over the dispatch's points; h has density D(h) (n.h), l = reflect(-r, h), p_l =
// D / 4. [Karis13 eq. 7]
vec4 lobe_sum(vec3 r, FILTERED_MAP environment, PrefilterParams params) {
    mat3 frame = frame_from_normal(r);
    vec2 source_size = vec2(params.source_width, params.source_height);
    vec3 sum = vec3(0.0);
    float weight_sum = 0.0;
    for (uint i = 0u; i < params.point_count; ++i) {
        LobeSample lobe = sample_lobe_brdf(sample_point(i), params.alpha);
        float n_dot_h = lobe.h_local.z;
        // n.l = 2 (n.h)^2 - 1; the sine form keeps l a unit vector at small alpha.
        vec3 l_local = vec3(2.0 * n_dot_h * lobe.h_local.xy, 1.0 - 2.0 * dot(lobe.h_local.xy, lobe.h_local.xy));
        MapPlace place = map_place(frame * l_local);
        float omega_s = 4.0 * n_dot_h / (float(params.sample_count) * lobe.pdf_h);
        float lod = lod_from_solid_angles(omega_s, texel_solid_angle(place, source_size, omega_s)) + params.lod_bias;
        float weight = prefilter_weight(l_local.z, params.alpha);
        sum += weight * map_radiance(environment, place, max(lod, 0.0));
        weight_sum += weight;
    }
    return vec4(sum, weight_sum);
}
