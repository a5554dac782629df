// Method `sampled-vndf`: importance sampling of the normals that v sees, each lookup filtered by
// its solid angle.
//
// l = reflect(-v, m) has density p_l, and the weight is f (n.l) / p_l = F G2 D / (4 (n.v) p_l): F
// G2 / G1(v) if m has the density of visible normals, less if a bounded cap excludes samples below
// the horizon.

#include "lib/filtered_sample.glsl"
#include "lib/frame.glsl"
#include "generated/specialization/masking.glsl"
#include "lib/microfacet.glsl"
#include "lib/sampling.glsl"
#include "lib/surface.glsl"

vec3 specular_radiance(Surface s) {
    mat3 frame = frame_of_surface(s);
    vec3 v_local = s.v * frame;
    v_local.z = s.n_dot_v;
    VisibleNormals normals = visible_normals_brdf(v_local, s.width);
    float g1_v = g1(v_local, s.width, MASKING);

    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < params.point_count; ++i) {
        VisibleSample visible = sample_visible_normal(normals, sample_point(i));
        float v_dot_h = dot(v_local, visible.h_local);
        vec3 l_local = 2.0 * v_dot_h * visible.h_local - v_local;
        vec3 li = sampled_radiance(frame * l_local, 1.0 / (float(params.sample_count) * visible.pdf_l));
        float g = g2_from_g1(g1_v, g1(l_local, s.width, MASKING), MASKING);
        // A select, not a branch: neighbours would wait for the lookup anyway.
        sum += li * fresnel(v_dot_h, s.f0) * (l_local.z > 0.0 && v_dot_h > 0.0 ? g * visible.d_over_pdf : 0.0);
    }
    return sum / float(params.sample_count);
}
