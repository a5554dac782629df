// GGX's D and its visible normals, for models that have no visible normals of their own;
// src/instrument/brdf says how well they serve each. Vectors are local (n is +z); widths are in
// [ALPHA_MIN, 1].

#include "lib/elementary.glsl"
#include "lib/widths.glsl"

// D(h), 1/sr. The sine comes from h.xy: 1 - h.z^2 has no digits left at small alpha. [Walter07 eq.
// 33]
float d_ggx(vec3 h_local, float alpha) {
    float alpha2 = alpha * alpha;
    float k = dot(h_local.xy, h_local.xy) + alpha2 * h_local.z * h_local.z;
    return h_local.z > 0.0 ? alpha2 / (PI * k * k) : 0.0;
}

// The same for two widths.
float d_ggx(vec3 h_local, vec2 width) {
    if (ANISOTROPY == ANISOTROPY_NONE) {
        return d_ggx(h_local, width.y);
    }
    float q = unstretched(h_local, width).w;
    return h_local.z > 0.0 ? 1.0 / (PI * width.x * width.y * (q * q) * (q * q)) : 0.0;
}

// G1(w) over n_dot_w: finite if the cosine is 0. [Walter07 eq. 34]
float g1_over_cosine_ggx(float n_dot_w, float alpha) {
    float alpha2 = alpha * alpha;
    return 2.0 / (n_dot_w + sqrt(alpha2 + (1.0 - alpha2) * n_dot_w * n_dot_w));
}

// Half vector among the normals that GGX of those widths shows to v: the half vectors of the
// spherical cap that the stretched v reflects into; xi.x = 0 is the cap's centre. [Dupuy23 listing
// 3]
vec3 sample_visible_ggx(vec2 xi, vec3 v_local, vec2 width) {
    vec3 v_standard = normalize(vec3(width * v_local.xy, v_local.z));
    // The cap's point is (sin phi-part, 1 - d); sine and z + v.z are written in d and 1 - xi.x,
    // which cancel no digits.
    float d = xi.x * (1.0 + v_standard.z);
    vec2 cap = sqrt(max(d * (2.0 - d), 0.0)) * sin_cos_turns(xi.y).yx;
    return normalize(vec3(width * (cap + v_standard.xy), (1.0 - xi.x) * (1.0 + v_standard.z)));
}

// Density of l = reflect(-v, h) per solid angle of l under sample_visible_ggx: D G1(v) / (4
// n_dot_v). [Heitz18 eq. 17]
float pdf_visible_l_ggx(vec3 v_local, vec3 h_local, vec2 width) {
    bool visible = v_local.z > 0.0 && dot(v_local, h_local) > 0.0;
    float alpha_v = width_along(v_local, width);
    return visible ? 0.25 * d_ggx(h_local, width) * g1_over_cosine_ggx(v_local.z, alpha_v) : 0.0;
}
