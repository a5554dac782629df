// The weight of a direction in a prefiltered texel.

#include "generated/specialization/masking.glsl"
#include "generated/specialization/prefilter_weight.glsl"
#include "lib/microfacet.glsl"

// By its cosine to n; 0 below the horizon.
float prefilter_weight(float n_dot_l, float alpha) {
    if (PREFILTER_WEIGHT == PREFILTER_WEIGHT_COSINE) {
        return max(n_dot_l, 0.0);
    }
    if (n_dot_l <= 0.0) {
        return 0.0;
    }
    return PREFILTER_WEIGHT == PREFILTER_WEIGHT_MASKING ? g1(n_dot_l, alpha, MASKING) : 1.0;
}
