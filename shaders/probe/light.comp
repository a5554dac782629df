// One invocation evaluates lib/light.glsl for one item.
// In: position_or_direction and color_kind of a light, (world position, 0).
// Out: (l, 0), (irradiance on a surface that faces it, 0).
// Set 0: 0 inputs, 3 vec4 an item; 1 outputs, 2 vec4 an item.

#include "lib/light.glsl"
#include "probe/item.glsl"

void main() {
    uint item = gl_GlobalInvocationID.x;
    if (item >= params.count) {
        return;
    }
    LightData light = LightData(inputs[item * 3u], inputs[item * 3u + 1u]);
    LightSample light_sample = light_at(light, inputs[item * 3u + 2u].xyz);
    outputs[item * 2u] = vec4(light_sample.l, 0.0);
    outputs[item * 2u + 1u] = vec4(light_sample.irradiance, 0.0);
}
