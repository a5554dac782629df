// A shaded point as the g-buffer holds it.

#include "generated/constants.glsl"
#include "generated/layout.glsl"
#include "lib/frame.glsl"
#include "lib/widths.glsl"

struct Surface {
    // Unit vectors away from the surface.
    vec3 n;
    vec3 v;
    vec3 albedo;
    vec3 f0;
    // Microfacet width in [ALPHA_MIN, 1]; the floor means a mirror. Of two widths, the mean for
    // lookups that know one.
    float alpha;
    // Widths along t and across it; both alpha if lobes have one width.
    vec2 width;
    // Unit tangent, orthogonal to n; set if lobes have two widths.
    vec3 t;
    float metallic;
    // Cosine between n and v, at least COSINE_MIN.
    float n_dot_v;
};

// The surface of four g-buffer texels: position and mask, normal and alpha, albedo and metallic, f0
// and material index; in world axes. False if nothing is hit; `s` is then not set.
bool surface_from_gbuffer(vec4 position, vec4 normal, vec4 albedo, vec4 f0, vec4 eye, out Surface s) {
    if (position.w == 0.0) {
        return false;
    }
    s.n = normalize(normal.xyz);
    s.v = eye.w == 0.0 ? eye.xyz : normalize(eye.xyz - position.xyz);
    s.albedo = albedo.rgb;
    s.f0 = f0.rgb;
    s.alpha = max(normal.w, ALPHA_MIN);
    s.width = vec2(s.alpha);
    s.metallic = albedo.w;
    s.n_dot_v = max(dot(s.n, s.v), COSINE_MIN);
    return true;
}

// The surface with two widths: `tangent` is that texel of the g-buffer, with the strength in w. A
// tangent along n, which normal maps can cause, gives way to the east.
Surface surface_with_tangent(Surface s, vec4 tangent) {
    vec3 t = tangent.xyz - dot(tangent.xyz, s.n) * s.n;
    s.t = dot(t, t) > TILT_MIN * TILT_MIN ? normalize(t) : east(s.n);
    s.width = widths_from_strength(s.alpha, tangent.w);
    s.alpha = mean_width(s.width);
    return s;
}

// F0 of what reflects light before the diffuse term gets it: the lobe's, or in a mixture of two BRDFs
// the dielectric's. A metal has no diffuse term, and any F0 here.
vec3 f0_over_diffuse(Surface s, uint flags) {
    if ((flags & SHADE_FLAG_MIX_BRDFS) == 0u || s.metallic >= 1.0) {
        return s.f0;
    }
    return clamp((s.f0 - s.metallic * s.albedo) / (1.0 - s.metallic), 0.0, 1.0);
}

// The frame of the lobe: columns tangent, bitangent, n.
mat3 frame_of_surface(Surface s) {
    return ANISOTROPY == ANISOTROPY_NONE ? frame_from_normal(s.n) : mat3(s.t, cross(s.n, s.t), s.n);
}

// A world direction in the environment's frame.
vec3 environment_from_world(vec3 d, ShadeParams params) {
    return vec3(dot(params.environment_from_world_0.xyz, d), dot(params.environment_from_world_1.xyz, d),
                dot(params.environment_from_world_2.xyz, d));
}

// The surface with n and v in the environment's frame.
Surface surface_in_environment(Surface s, ShadeParams params) {
    s.n = environment_from_world(s.n, params);
    s.v = environment_from_world(s.v, params);
    if (ANISOTROPY != ANISOTROPY_NONE) {
        s.t = environment_from_world(s.t, params);
    }
    return s;
}
