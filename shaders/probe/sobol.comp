// One invocation evaluates the functions of lib/sobol.glsl for one item. In: (pixel x, pixel y,
// scramble, seed), (stream, index, 0, 0), as whole numbers below 2^24. Out: the bits of both pairs'
// points, 16 a channel: (lobe x high, low, y high, low), (environment x high, low, y high, low).
// Set 0: 0 inputs, 2 vec4 an item; 1 outputs, 2 vec4 an item.

#include "lib/sobol.glsl"
#include "probe/item.glsl"

void main() {
    uint item = gl_GlobalInvocationID.x;
    if (item >= params.count) {
        return;
    }
    uvec4 place = uvec4(inputs[item * 2u]);
    uvec2 stream_index = uvec2(inputs[item * 2u + 1u].xy);
    uint key = sobol_key(place.xy, place.z, place.w, stream_index.x);
    uint second = sobol_second_reversed(stream_index.y);
    for (uint pair = 0u; pair < 2u; ++pair) {
        uvec2 point = sobol_point(stream_index.y, second, sobol_next_pair_key(key));
        outputs[item * 2u + pair] =
            vec4(float(point.x >> 16), float(point.x & 0xffffu), float(point.y >> 16), float(point.y & 0xffffu));
    }
}
