// The diffuse term next to the specular one.
#ifndef DIFFUSE_GLSL
#define DIFFUSE_GLSL

#include "lib/prefilter_mapping.glsl"
#include "lib/surface.glsl"

// Albedo of the diffuse term: what the specular lobe does not reflect, (1 - (f0 A + B)) (1 - metallic) albedo. The
// table's value at n_dot_v stands for the whole lobe; Schlick at n_dot_v would darken rough rims. [Kim22 "IBL", Kd]
vec3 diffuse_albedo(Surface s, sampler2D dfg, uint flags) {
    vec3 albedo = (1.0 - s.metallic) * s.albedo;
    if ((flags & SHADE_FLAG_NO_SPECULAR) != 0u) {
        return albedo;
    }
    vec2 a_b = textureLod(dfg, dfg_uv(s.n_dot_v, s.alpha), 0.0).rg;
    return (1.0 - (s.f0 * a_b.x + a_b.y)) * albedo;
}

#endif
