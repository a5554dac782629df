// One invocation adds a sheen (second) to its base (first); src/instrument/shade/sheen.rs has the
// equations and the sources of the fits. Bindings: lib/layered_pixel.glsl.

#include "lib/layered_pixel.glsl"

float three_albedo(float n_dot_v, float pr) {
    float inverse = 1.0 / (pr + 0.1);
    float a = -1.9362 + 1.0678 * pr + 0.4573 * pr * pr - 0.8469 * inverse;
    float b = -0.6014 + 0.5538 * pr - 0.4670 * pr * pr - 0.1255 * inverse;
    return exp(a * n_dot_v + b);
}

float three_albedo_before(float n_dot_v, float pr) {
    if (pr < 0.25) {
        float a = -339.2 * pr * pr + 161.4 * pr - 25.9;
        float b = 44.0 * pr * pr - 23.7 * pr + 3.26;
        return exp(a * n_dot_v + b);
    }
    float a = -8.48 * pr * pr + 14.3 * pr - 9.95;
    float b = 1.97 * pr * pr - 3.27 * pr + 0.72;
    return exp(a * n_dot_v + b) + 0.1 * (pr - 0.25);
}

float materialx_albedo(float x, float pr) {
    float alpha = pr * pr;
    float up = 13.673 - 68.78018 * x + 799.08825 * alpha - 905.00061 * x * alpha + 60.28956 * x * x
             + 1086.96473 * alpha * alpha;
    float down = 1.0 + 61.57746 * x + 442.78211 * alpha + 2597.49308 * x * alpha + 121.81241 * x * x
               + 3045.55075 * alpha * alpha;
    return up / down;
}

float albedo_of(uint kind, float exact, float n_dot_v, float pr) {
    switch (kind) {
        case SHEEN_ALBEDO_ONE: return 1.0;
        case SHEEN_ALBEDO_EXACT: return exact;
        case SHEEN_ALBEDO_THREE: return clamp(three_albedo(n_dot_v, pr), 0.0, 1.0);
        case SHEEN_ALBEDO_PLAYCANVAS: return clamp(three_albedo_before(n_dot_v, 1.0 - pr), 0.0, 1.0);
        case SHEEN_ALBEDO_MATERIALX: return clamp(materialx_albedo(n_dot_v, pr), 0.0, 1.0);
        default: return SHEEN_LOSS;
    }
}

void main() {
    LayeredPixel pixel;
    if (!layered_pixel(pixel)) {
        return;
    }
    vec2 pair = layer_albedo_pair(pixel);
    float exact = pair.x + pair.y;
    float pr = sqrt(max(pixel.alpha, SHEEN_ALPHA_MIN));
    vec3 color = pixel.weight.rgb;
    float loss = max(max(color.r, color.g), color.b) * albedo_of(params.loss, exact, pixel.n_dot_v, pr);
    vec3 share = albedo_of(params.scale, exact, pixel.n_dot_v, pr) * color;
    uint i = pixel.index;
    whole[i] = max(1.0 - loss, 0.0) * first[i] + vec4(share, 0.0) * second[i];
}
