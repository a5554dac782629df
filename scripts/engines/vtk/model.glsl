// VTK: the map along r. F0 is raised by a Fresnel factor of n.v before the table, which has that factor too (k_S in the shader of
// vtkOpenGLPolyDataMapper, as in the listing of Fdez-Agüera's paper).
#include "lib/split_sum.glsl"

vec3 specular_radiance(Surface s) {
    float roughness = perceptual_roughness_from_alpha(s.alpha);
    vec3 raised = s.f0 + (max(vec3(1.0 - roughness), s.f0) - s.f0) * pow(1.0 - s.n_dot_v, 5.0);
    vec2 a_b = albedo_pair(s);
    return prefiltered_radiance(reflect(-s.v, s.n), roughness) * (raised * a_b.x + a_b.y);
}
