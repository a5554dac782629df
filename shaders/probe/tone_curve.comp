// One invocation evaluates lib/tone_curve.glsl for one item.
// In: (linear RGB, 0), (exposure, contrast, 0, 0).
// Out: (display RGB, the packed pixel without A as a number).
// Set 0: 0 inputs, 2 vec4 an item; 1 outputs, 1 vec4 an item.

#include "lib/tone_curve.glsl"
#include "probe/item.glsl"

void main() {
    uint item = gl_GlobalInvocationID.x;
    if (item >= params.count) {
        return;
    }
    vec4 exposure_contrast = inputs[item * 2u + 1u];
    vec3 c = tone_curve(inputs[item * 2u].rgb, exposure_contrast.x, exposure_contrast.y);
    outputs[item] = vec4(c, float(pack_rgba8(c) & 0xffffffu));
}
