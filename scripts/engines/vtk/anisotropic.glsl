// VTK on a lobe of two widths: along r of a normal bent by the whole strength (`--bend vtk`), with the factors of `split-sum-vtk` at the
// geometric mean of the widths.
#include "lib/split_sum.glsl"

vec3 specular_radiance(Surface s) {
    float alpha = sqrt(s.width.x * s.width.y);
    float roughness = perceptual_roughness_from_alpha(alpha);
    float strength = min((1.0 - s.width.y / s.width.x) / 0.9, 1.0);
    vec3 bitangent = frame_of_surface(s)[1];
    vec3 bent = normalize(mix(s.n, s.v - dot(s.v, bitangent) * bitangent, strength));
    vec2 a_b = albedo_pair(dfg, s.n_dot_v, alpha);
    vec3 raised = mix(s.f0, max(s.f0, 1.0 - roughness), schlick_weight(s.n_dot_v));
    return prefiltered_radiance(reflect(-s.v, bent), roughness) * (raised * a_b.x + a_b.y);
}
