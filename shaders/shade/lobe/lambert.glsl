// The diffuse lobe of the reference: a Lambert surface of albedo 1, so that its radiance is
// irradiance / pi. Factors that do not depend on l (albedo, metallic, the Fresnel weight) are
// applied when the estimate is resolved.
//
// Every file in shade/lobe/ defines the same functions.

#include "lib/diffuse.glsl"
#include "lib/frame.glsl"
#include "lib/lobe.glsl"
#include "lib/surface.glsl"

struct Lobe {
    // Columns are the axes of local vectors, n last.
    mat3 frame;
    // With a lobe for multiple scattering (kulla-conty), the weights of both.
    DiffuseWeights weights;
    float alpha;
    float mean_albedo;
};

#include "lib/cosine_lobe.glsl"

Lobe lobe_at(Surface surface, ShadeParams params) {
    Lobe lobe = Lobe(frame_from_normal(surface.n), DiffuseWeights(vec3(1.0), vec3(0.0)), surface.alpha, 0.0);
    if (COMPENSATION == COMPENSATION_KULLA_CONTY) {
        lobe.weights = diffuse_weights(surface, dfg, params.flags);
        lobe.mean_albedo = mean_albedo(dfg, surface.alpha);
    }
    return lobe;
}

// BRDF times n_dot_l, and the density (1/sr) with which `lobe_sample` returns l.
LobeValue lobe_eval(Lobe lobe, vec3 l_local) {
    float cos_over_pi = max(l_local.z, 0.0) / PI;
    vec3 weight = vec3(1.0);
    if (COMPENSATION == COMPENSATION_KULLA_CONTY) {
        weight = lobe.weights.transmitted
            + lobe.weights.multiple * multiple_lobe(dfg, l_local.z, lobe.alpha, lobe.mean_albedo);
    }
    return LobeValue(weight * cos_over_pi, cos_over_pi);
}

vec3 lobe_weight(Surface surface, sampler2D dfg, uint flags) {
    return COMPENSATION == COMPENSATION_KULLA_CONTY ? vec3(1.0) : diffuse_albedo(surface, dfg, flags);
}
