// The directional albedo f0 A + B of the specular lobe: the second factor of the split sum.
// [Karis13 eq. 8]
//
// A = integral of D G / (4 n.v) (1 - Fc) dl, B the same with Fc the weight of f90. With dl = 4 (v.h) dh
// and h written by
//     r = alpha cos / sqrt(sin^2 + alpha^2 cos^2), for which D_ggx (n.h) dh = 2 r dr dphi / 2 pi,
// the weight of a node is G (v.h) / ((n.v) (n.h)) D / D_ggx: bounded if the tail of D is at most as
// long as GGX's. For a longer one r times the weight must be bounded, since dh has the factor r. l is
// above the horizon for every azimuth up to the polar angle pi/4 - theta_v/2 of h, for none from
// pi/4 + theta_v/2 on, and in between up to cos phi = c0. Each range is integrated on its own by
// midpoints of x - sin(2 pi x) / 2 pi, which makes every integrand periodic and the midpoint rule
// converge fast; sampled points would have to resolve the horizon (1e-3 at 1024 points).

#include "lib/elementary.glsl"
#include "lib/microfacet.glsl"
#include "lib/prefilter_weight.glsl"

// Nodes in azimuth over half a turn (the integrand is even). 16 leave 1.5e-5 with rational masking,
// which has a kink.
const uint ALBEDO_PHI_COUNT = 16;

// Nodes for the rungs of the ladder, whose factors must be practically exact: twice as many as
// leave 3e-5.
const uint LADDER_NODES = 2048;

// Node i of count of the periodising rule on [0, 1], and its weight. [Sidi93, the sin^2
// transformation]
vec2 periodic_node(uint i, uint count) {
    float x = (float(i) + 0.5) / float(count);
    vec2 sin_cos = sin_cos_turns(x);
    return vec2(x - sin_cos.x * (0.5 / PI), (1.0 - sin_cos.y) / float(count));
}

// r of a polar angle of h from its sine and cosine squared. At grazing views the argument is nearly
// 1, and a square root as coarse as Vulkan allows exceeds it: such an r has no sine.
float ggx_r(float sin2, float cos2, float alpha2) {
    return min(sqrt(alpha2 * cos2 / (sin2 + alpha2 * cos2)), 1.0);
}

// (A, B), and in zw the means of the weight w(l) and of Fc w(l) over h of density D (n.h): the
// normalisation of the kernels D (n.h) w / (4 v.h) and Fc times it. 768 nodes leave at most 4e-5,
// for correlated masking below n_dot_v 0.004 1e-4; 1024 nodes 4e-5. For n_dot_v >= COSINE_MIN and
// alpha >= ALPHA_MIN.
vec4 directional_albedo(float n_dot_v, float alpha, uint node_count, uint masking) {
    float alpha2 = alpha * alpha;
    float sin_v = sqrt(max(1.0 - n_dot_v * n_dot_v, 0.0));
    float g1_v = g1(n_dot_v, alpha, masking);
    // sin^2 and cos^2 of pi/4 - theta_v/2 are (1 - sin_v)/2 and (1 + sin_v)/2; 1 - sin_v without
    // its cancellation.
    float low2 = 0.5 * n_dot_v * n_dot_v / (1.0 + sin_v);
    float high2 = 0.5 * (1.0 + sin_v);
    vec3 r_ends = vec3(1.0, ggx_r(low2, high2, alpha2), ggx_r(high2, low2, alpha2));
    uint r_count = max(node_count / (2u * ALBEDO_PHI_COUNT), 1u);

    vec4 sum = vec4(0.0);
    for (uint range = 0u; range < 2u; ++range) {
        for (uint i = 0u; i < r_count; ++i) {
            vec2 r_node = periodic_node(i, r_count);
            float r = mix(r_ends[range], r_ends[range + 1u], r_node.x);
            float u = (1.0 - r) * (1.0 + r);
            float k = 1.0 / (1.0 + (alpha2 - 1.0) * u);
            float cos_h = r * sqrt(k);
            float sin_h = alpha * sqrt(u * k);
            float phi_end = PI;
            if (range == 1u) {
                // n.l = 2 (v.h) (n.h) - n.v = 0 at cos phi = c0.
                float c0 = n_dot_v * (0.5 / cos_h - cos_h) / max(sin_v * sin_h, 1e-30);
                c0 = clamp(c0, -1.0, 1.0);
                phi_end = atan2_precise(sqrt((1.0 - c0) * (1.0 + c0)), c0);
            }
            // The distribution does not depend on the azimuth.
            float k_ggx = sin_h * sin_h + alpha2 * cos_h * cos_h;
            float d_ratio = d_brdf(vec3(sin_h, 0.0, cos_h), alpha) * PI * k_ggx * k_ggx / alpha2;
            float r_weight = r_node.y * (r_ends[range] - r_ends[range + 1u]) * 2.0 * r;
            r_weight *= (phi_end / PI) * d_ratio;
            for (uint j = 0u; j < ALBEDO_PHI_COUNT; ++j) {
                vec2 phi_node = periodic_node(j, ALBEDO_PHI_COUNT);
                float cos_phi = sin_cos_turns(phi_node.x * phi_end * (0.5 / PI)).y;
                float v_dot_h = sin_v * sin_h * cos_phi + n_dot_v * cos_h;
                float n_dot_l = 2.0 * v_dot_h * cos_h - n_dot_v;
                float gv = g2_from_g1(g1_v, g1(n_dot_l, alpha, masking), masking) * v_dot_h / (n_dot_v * cos_h);
                float fc = fresnel_weight(v_dot_h);
                float weight = prefilter_weight(n_dot_l, alpha);
                sum += r_weight * phi_node.y * vec4(gv * (1.0 - fc), gv * fc, weight, weight * fc);
            }
        }
    }
    return sum;
}

// The same mean for v = n, independent of the azimuth: the normalisation of D/4 w(l).
float mirror_weight(float alpha) {
    const uint NODE_COUNT = 64u;
    float alpha2 = alpha * alpha;
    float r_end = ggx_r(0.5, 0.5, alpha2);
    float sum = 0.0;
    for (uint i = 0u; i < NODE_COUNT; ++i) {
        vec2 node = periodic_node(i, NODE_COUNT);
        float r = mix(1.0, r_end, node.x);
        float u = (1.0 - r) * (1.0 + r);
        float k = 1.0 / (1.0 + (alpha2 - 1.0) * u);
        float cos_h = r * sqrt(k);
        float sin_h = alpha * sqrt(u * k);
        float k_ggx = sin_h * sin_h + alpha2 * cos_h * cos_h;
        float d_ratio = d_brdf(vec3(sin_h, 0.0, cos_h), alpha) * PI * k_ggx * k_ggx / alpha2;
        sum += node.y * (1.0 - r_end) * 2.0 * r * d_ratio * prefilter_weight(1.0 - 2.0 * sin_h * sin_h, alpha);
    }
    return sum;
}
