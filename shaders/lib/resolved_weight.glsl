// The factor of a lobe's estimate that does not depend on l: its own, and for specular lobes the
// one of a compensation. To be included below selected/lobe.glsl.

#include "lib/compensation.glsl"

vec3 resolved_weight(Surface s, sampler2D dfg, uint flags) {
    vec3 weight = lobe_weight(s, dfg, flags);
    // Only the specular lobes are scaled.
    if (LOBE_STREAM == 0u && COMPENSATION != COMPENSATION_NONE) {
        weight *= compensation_factor(s.f0, albedo_pair(dfg, s.n_dot_v, s.alpha), dfg, s.alpha);
    }
    return weight;
}
