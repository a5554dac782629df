// One invocation evaluates every function of the selected BRDF model and of lib/microfacet.glsl for
// one item. In: (v_local, alpha), (h_local, n_dot_l), (u, xi.y, cos phi, sin phi), (f0, 0),
// (l_local, 0). Out: (d(h), g1(v), g1(n_dot_l), g2), (sample_d(u, cos phi, sin phi), 0), (lobe of
// xi, pdf_h), (sample_visible(xi), 0), (pdf_visible_l(v, h), pdf_visible_l of its own sample, pdf_l
// and d_over_pdf of the next), (fresnel(v_dot_h, f0), 0), (eval(v, l, h), 0),
// (sample_visible_normal(xi), 0). Specialization constant 0 is the masking-shadowing. Set 0: 0
// inputs, 5 vec4 an item; 1 outputs, 8 vec4 an item.

#include "generated/specialization/masking.glsl"
#include "lib/microfacet.glsl"
#include "probe/item.glsl"

void main() {
    uint item = gl_GlobalInvocationID.x;
    if (item >= params.count) {
        return;
    }
    vec3 v_local = inputs[item * 5u].xyz;
    float alpha = inputs[item * 5u].w;
    vec3 h_local = inputs[item * 5u + 1u].xyz;
    float n_dot_l = inputs[item * 5u + 1u].w;
    vec4 xi = inputs[item * 5u + 2u];
    vec3 f0 = inputs[item * 5u + 3u].xyz;
    vec3 l_local = inputs[item * 5u + 4u].xyz;
    float g1_v = g1(v_local.z, alpha, MASKING);
    float g1_l = g1(n_dot_l, alpha, MASKING);
    LobeSample lobe = sample_lobe_brdf(sample_point_from_xi(xi.xy), alpha);
    vec3 visible = sample_visible_brdf(xi.xy, v_local, vec2(alpha));
    VisibleSample own = sample_visible_normal(visible_normals_brdf(v_local, vec2(alpha)), sample_point_from_xi(xi.xy));
    uint first = item * 8u;
    outputs[first] = vec4(d_brdf(h_local, alpha), g1_v, g1_l, g2_from_g1(g1_v, g1_l, MASKING));
    outputs[first + 1u] = vec4(sample_d_brdf(xi.x, xi.zw, alpha), 0.0);
    outputs[first + 2u] = vec4(lobe.h_local, lobe.pdf_h);
    outputs[first + 3u] = vec4(visible, 0.0);
    outputs[first + 4u] =
        vec4(pdf_visible_l_brdf(v_local, h_local, vec2(alpha)), pdf_visible_l_brdf(v_local, visible, vec2(alpha)), own.pdf_l, own.d_over_pdf);
    outputs[first + 5u] = vec4(fresnel(dot(v_local, h_local), f0), 0.0);
    outputs[first + 6u] = vec4(eval_brdf(v_local, l_local, h_local, vec2(alpha), f0, MASKING), 0.0);
    outputs[first + 7u] = vec4(own.h_local, 0.0);
}
