// The split sums of engines whose factors are not F0 A + B, all along r;
// src/instrument/shade/method/split_sum_factors.rs has the sources.
#pragma methods split-sum-vtk split-sum-playcanvas split-sum-babylon

#include "lib/fresnel.glsl"
#include "lib/split_sum.glsl"

vec3 specular_radiance(Surface s) {
    float roughness = perceptual_roughness_from_alpha(s.alpha);
    vec3 lobe = prefiltered_radiance(reflect(-s.v, s.n), roughness);
#if defined(SPLIT_SUM_VTK)
    vec3 raised = mix(s.f0, max(s.f0, 1.0 - roughness), schlick_weight(s.n_dot_v));
    vec2 a_b = albedo_pair(s);
    return lobe * (raised * a_b.x + a_b.y);
#elif defined(SPLIT_SUM_PLAYCANVAS)
    float gloss = 1.0 - roughness;
    vec3 grazing = max(s.f0, gloss * gloss * max(s.f0.r, max(s.f0.g, s.f0.b)));
    return lobe * mix(s.f0, grazing, schlick_weight(s.n_dot_v));
#elif defined(SPLIT_SUM_BABYLON)
    return mix(lobe, prefiltered_radiance(s.n, 1.0), s.alpha) * reflectance(s);
#endif
}
