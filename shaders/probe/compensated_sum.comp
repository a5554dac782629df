// One invocation sums with lib/compensated_sum.glsl for one item.
// In: (start, 0), (term, count).
// Out: (start plus count times the term: high part, 0), (low part, 0).
// Set 0: 0 inputs, 2 vec4 an item; 1 outputs, 2 vec4 an item.

#include "lib/compensated_sum.glsl"
#include "probe/item.glsl"

void main() {
    uint item = gl_GlobalInvocationID.x;
    if (item >= params.count) {
        return;
    }
    CompensatedSum sum = CompensatedSum(inputs[item * 2u].xyz, vec3(0.0));
    vec4 term_count = inputs[item * 2u + 1u];
    for (uint i = 0u; i < uint(term_count.w); ++i) {
        sum = compensated_add(sum, term_count.xyz);
    }
    outputs[item * 2u] = vec4(sum.high, 0.0);
    outputs[item * 2u + 1u] = vec4(sum.low, 0.0);
}
