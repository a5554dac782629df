// The weight of a direction in a prefiltered texel.

#include "lib/masking.glsl"
#include "lib/microfacet.glsl"

// One of PREFILTER_WEIGHT_*, set when the pipeline is made.
layout(constant_id = 3) const uint PREFILTER_WEIGHT = 0;

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
