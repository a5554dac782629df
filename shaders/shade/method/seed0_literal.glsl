// Method `seed0-literal`: the estimator that source document 0 prints, to show what its slips cost:
//     1/N sum of F G / (4 (n.l) (n.v)) L (n.l), at level 0.5 (log2(W H / N) - log2 D(h)),
// with l drawn in the D-shaped lobe about the mirror direction. It does not converge to the specular integral: the
// density of l is missing, and the level misses 2 pi^2 sin(theta) and the Jacobian. [Kim22 "IBL", "Mipmap"] One slip is
// not followed: the misprinted G of GGX, 1 + alpha^2 + tan^2, is read as 1 + alpha^2 tan^2.
#ifndef METHOD_SEED0_LITERAL_GLSL
#define METHOD_SEED0_LITERAL_GLSL

#include "lib/equirect.glsl"
#include "lib/frame.glsl"
#include "lib/masking.glsl"
#include "lib/microfacet.glsl"
#include "lib/sampling.glsl"
#include "lib/surface.glsl"

// Width of the lobe that the document's angles make. Phong's has cos = (1 - u)^(1 / (exponent + 1)) where 1 / (exponent + 2) is right. Every
// other model, one that the document does not have among them, is drawn by its own D. [Kim22 "IBL"]
float lobe_alpha(float alpha) {
#ifdef BRDF_PHONG_GLSL
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
    float drawn_alpha = lobe_alpha(s.alpha);
    float lod_max = float(textureQueryLevels(environment) - 1);
    float sample_count = float(params.sample_count);
    float texels_per_sample = float(params.environment_width) * float(params.environment_height) / sample_count;

    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < params.point_count; ++i) {
        vec3 l = mirror_frame * sample_lobe_brdf(sample_point(i), drawn_alpha).h_local;
        vec3 l_local = l * frame;
        vec3 h_local = normalize(v_local + l_local);
        // Where D(h) is 0 in f32 the printed level is infinite: the coarsest one.
        float d = d_brdf(h_local, s.alpha);
        float lod = d > 0.0 ? clamp(0.5 * log2(texels_per_sample / d), 0.0, lod_max) : lod_max;
        vec3 li = textureLod(environment, uv_from_direction(l), lod).rgb;
        float g = g2_from_g1(g1_v, g1(l_local.z, s.alpha, MASKING), MASKING);
        sum += l_local.z > 0.0 ? li * f_schlick(dot(v_local, h_local), s.f0) * g : vec3(0.0);
    }
    return sum / (4.0 * sample_count * s.n_dot_v);
}

#endif
