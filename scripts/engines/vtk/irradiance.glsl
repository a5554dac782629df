// VTK's weight of irradiance over pi: multiple scattering, and a diffuse term of 0.96 times the albedo. Both take the F0 that Fresnel's
// factor at n.v has raised (vtkOpenGLPolyDataMapper::ReplaceShaderLight, 9.7.1; `split-sum-vtk` is its specular term).
#include "lib/split_sum.glsl"

vec3 specular_radiance(Surface s) {
    float alpha = sqrt(s.width.x * s.width.y);
    float roughness = perceptual_roughness_from_alpha(alpha);
    vec2 a_b = albedo_pair(dfg, s.n_dot_v, alpha);
    vec3 single = mix(s.f0, max(s.f0, 1.0 - roughness), schlick_weight(s.n_dot_v)) * a_b.x + a_b.y;
    float lost = 1.0 - (a_b.x + a_b.y);
    vec3 average = s.f0 + (1.0 - s.f0) / 21.0;
    vec3 multiple = lost * single * average / max(1.0 - average * lost, 1e-5);
    return multiple + 0.96 * (1.0 - s.metallic) * s.albedo * (1.0 - single - multiple);
}
