// The specular integral by importance sampling of D.
//
// m has density D(m) (n.m), l = reflect(-v, m), so p_l = D (n.m) / (4 v.m) and the weight is
//     f (n.l) / p_l = F G (v.m) / ((n.v) (n.m)).
// Directions below the horizon carry nothing but count in N. [Walter07 eq. 38, 41; Kim22 "IBL",
// corrected]

#include "lib/frame.glsl"
#include "generated/specialization/masking.glsl"
#include "lib/microfacet.glsl"
#include "lib/sampling.glsl"
#include "lib/surface.glsl"

// Radiance from l for a sample of solid angle omega_s = 1 / (N p_l) (sr); each method defines it.
vec3 sampled_radiance(vec3 l, float omega_s);

// The contribution of the point_count points of this dispatch, of sample_count in all, to the
// specular radiance.
vec3 importance_sampled_radiance(Surface s, uint sample_count, uint point_count) {
    mat3 frame = frame_of_surface(s);
    vec3 v_local = s.v * frame;
    float g1_v = g1(vec3(v_local.xy, s.n_dot_v), s.width, MASKING);

    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < point_count; ++i) {
        LobeSample lobe = sample_lobe_brdf(sample_point(i), s.width);
        float v_dot_h = dot(v_local, lobe.h_local);
        vec3 l_local = 2.0 * v_dot_h * lobe.h_local - v_local;
        vec3 li = sampled_radiance(frame * l_local, 4.0 * v_dot_h / (float(sample_count) * lobe.pdf_h));
        float g = g2_from_g1(g1_v, g1(l_local, s.width, MASKING), MASKING);
        float weight = g * v_dot_h / lobe.h_local.z;
        // A select, not a branch: neighbours would wait for the lookup anyway.
        sum += li * fresnel(v_dot_h, s.f0) * (l_local.z > 0.0 && v_dot_h > 0.0 ? weight : 0.0);
    }
    return sum / (float(sample_count) * s.n_dot_v);
}
