// The diffuse term next to the specular one.

#include "lib/bend.glsl"
#include "lib/compensation.glsl"
#include "lib/prefilter_mapping.glsl"
#include "lib/surface.glsl"

// Weights of irradiance over pi: the diffuse term, which gets the light that the specular one does
// not reflect, and the multiple scattering of a compensation. The table's value at n_dot_v
// represents the whole lobe; Schlick at n_dot_v would darken rough rims. [Kim22 "IBL", Kd]
struct DiffuseWeights {
    vec3 transmitted;
    vec3 multiple;
};

DiffuseWeights diffuse_weights(Surface s, sampler2D dfg, uint flags) {
    vec3 albedo = (1.0 - s.metallic) * s.albedo;
    if ((flags & SHADE_FLAG_NO_SPECULAR) != 0u) {
        return DiffuseWeights(albedo, vec3(0.0));
    }
    float alpha = table_alpha(s);
    vec2 a_b = albedo_pair(dfg, s.n_dot_v, alpha);
    vec3 f0 = f0_over_diffuse(s, flags);
    vec3 multiple = multiple_scattering(f0, a_b, dfg, alpha);
    vec3 reflected = (f0 * a_b.x + a_b.y) * compensation_factor(f0, a_b, dfg, alpha) + multiple;
    return DiffuseWeights((1.0 - reflected) * albedo, multiple);
}

vec3 diffuse_albedo(Surface s, sampler2D dfg, uint flags) {
    DiffuseWeights weights = diffuse_weights(s, dfg, flags);
    return weights.transmitted + weights.multiple;
}
