// The sheen lobe of the reference, for F = 1 and colour 1; src/instrument/brdf/sheen.rs has
// formulas and sources.
//
// Directions are uniform over the hemisphere: the facets of D lean to the horizon, so directions
// drawn by D have unbounded weights or lie below it. Here the weight 2 pi D V n.l is at most (2 +
// p)/4 for `ashikhmin`.

#include "generated/specialization/sheen_visibility.glsl"
#include "lib/elementary.glsl"
#include "lib/frame.glsl"
#include "lib/lobe.glsl"
#include "lib/surface.glsl"

// Gives this lobe other points than the others, so that their errors are independent.
const uint LOBE_STREAM = 3u;
const float UNIFORM = 0.5 / PI;

struct Lobe {
    mat3 frame;
    vec3 v_local;
    float alpha;
    float lambda_v;
};

float sheen_exponent(float x, float alpha) {
    float w = (1.0 - alpha) * (1.0 - alpha);
    float a = mix(21.5473, 25.3245, w);
    float b = mix(3.82987, 3.32435, w);
    float c = mix(0.19823, 0.16801, w);
    return a / (1.0 + b * pow(x, c)) + mix(-1.97760, -1.27393, w) * x + mix(-4.32054, -4.85967, w);
}

// Lambda of a direction: 1/G1 - 1.
float sheen_lambda(float x, float alpha) {
    if (SHEEN_VISIBILITY == SHEEN_VISIBILITY_ASHIKHMIN) {
        return 1.0 / x - 1.0;
    }
    return x < 0.5 ? exp(sheen_exponent(x, alpha))
                   : exp(2.0 * sheen_exponent(0.5, alpha) - sheen_exponent(1.0 - x, alpha));
}

Lobe lobe_at(Surface s, ShadeParams params) {
    mat3 frame = frame_from_normal(s.n);
    vec3 v_local = s.v * frame;
    v_local.z = s.n_dot_v;
    float alpha = max(s.alpha, SHEEN_ALPHA_MIN);
    return Lobe(frame, v_local, alpha, sheen_lambda(s.n_dot_v, alpha));
}

vec3 lobe_sample(Lobe lobe, vec2 xi) {
    return vec3(sqrt(xi.x * (2.0 - xi.x)) * sin_cos_turns(xi.y).yx, 1.0 - xi.x);
}

LobeValue lobe_eval(Lobe lobe, vec3 l_local) {
    vec3 h_local = normalize(lobe.v_local + l_local);
    float p = 1.0 / lobe.alpha;
    float d = (2.0 + p) * UNIFORM * pow(dot(h_local.xy, h_local.xy), 0.5 * p);
    float masked = 1.0 + lobe.lambda_v + sheen_lambda(max(l_local.z, COSINE_MIN), lobe.alpha);
    return LobeValue(vec3(d / (4.0 * lobe.v_local.z * masked)), UNIFORM);
}

float lobe_guide(Lobe lobe, vec3 l_local) {
    return l_local.z > 0.0 ? UNIFORM : 0.0;
}

float lobe_mirror(Lobe lobe) {
    return 0.0;
}

vec3 lobe_weight(Surface s, sampler2D dfg, uint flags) {
    return vec3(1.0);
}
