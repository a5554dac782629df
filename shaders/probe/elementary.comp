// One invocation evaluates lib/elementary.glsl for one item. In: (turns, x of log_one_minus, x of
// one_minus_exp, x of asin_half_octant), (y, x of atan2_precise, x of atan_octant, 0). Out: (sin,
// cos of turns, log_one_minus, one_minus_exp), (asin_half_octant, atan2_precise, atan_octant, 0).
// Set 0: 0 inputs, 2 vec4 an item; 1 outputs, 2 vec4 an item.

#include "lib/elementary.glsl"
#include "probe/item.glsl"

void main() {
    uint item = gl_GlobalInvocationID.x;
    if (item >= params.count) {
        return;
    }
    vec4 a = inputs[item * 2u];
    vec4 b = inputs[item * 2u + 1u];
    outputs[item * 2u] = vec4(sin_cos_turns(a.x), log_one_minus(a.y), one_minus_exp(a.z));
    outputs[item * 2u + 1u] = vec4(asin_half_octant(a.w), atan2_precise(b.x, b.y), atan_octant(b.z), 0.0);
}
