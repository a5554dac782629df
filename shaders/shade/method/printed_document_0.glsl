// Method `printed-document-0`: the estimator as source document 0 prints it, to show what its slips
// do [Kim22 "IBL", "Mipmap"]:
//     1/N sum of F G / (4 (n.l) (n.v)) L (n.l), at the level 0.5 (log2(W H / N) - log2 D(h)),
// with l in a lobe about the mirror direction. It divides by D(h) instead of the density of l. The
// printed G of GGX is replaced by the correct one.

#include "lib/equirect.glsl"
#include "lib/frame.glsl"
#include "generated/specialization/masking.glsl"
#include "lib/microfacet.glsl"
#include "lib/sampling.glsl"
#include "lib/surface.glsl"

// Width of the lobe of the printed angles: Phong's have the exponent a + 1 in place of a + 2.
float printed_lobe_alpha(float alpha) {
#ifdef BRDF_PHONG
    return alpha * sqrt(2.0 / (2.0 - alpha * alpha));
#else
    return alpha;
#endif
}

vec3 specular_radiance(Surface s) {
    mat3 frame = frame_from_normal(s.n);
    mat3 mirror_frame = frame_from_normal(normalize(reflect(-s.v, s.n)));
    vec3 v_local = s.v * frame;
    float g1_v = g1(s.n_dot_v, s.alpha, MASKING);
    float drawn_alpha = printed_lobe_alpha(s.alpha);
    float lod_max = float(textureQueryLevels(environment) - 1);
    vec2 size = vec2(textureSize(environment, 0));
    float texels_per_sample = size.x * size.y / float(params.sample_count);

    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < params.point_count; ++i) {
        vec3 l = mirror_frame * sample_lobe_brdf(sample_point(i), drawn_alpha).h_local;
        vec3 l_local = l * frame;
        vec3 h_local = normalize(v_local + l_local);
        // Where f32 has D = 0 the printed level is infinite.
        float d = d_brdf(h_local, s.alpha);
        float lod = d > 0.0 ? clamp(0.5 * log2(texels_per_sample / d), 0.0, lod_max) : lod_max;
        vec3 li = textureLod(environment, uv_from_direction(l), lod).rgb;
        float g = g2_from_g1(g1_v, g1(l_local.z, s.alpha, MASKING), MASKING);
        sum += l_local.z > 0.0 ? li * f_schlick(dot(v_local, h_local), s.f0) * g : vec3(0.0);
    }
    return sum / (4.0 * float(params.sample_count) * s.n_dot_v);
}
