// One invocation evaluates lib/sh.glsl for one item.
// In: (unit direction, 0).
// Out: basis functions 0 to 3, 4 to 7, (basis function 8, irradiance over pi of the coefficients, not floored).
// Set 0: 0 inputs, 1 vec4 an item; 1 outputs, 3 vec4 an item; 2 SH9_COUNT coefficients.

#include "lib/sh.glsl"
#include "probe/item.glsl"

layout(std430, set = 0, binding = 2) readonly buffer Coefficients {
    vec4 coefficients[SH9_COUNT];
};

void main() {
    uint item = gl_GlobalInvocationID.x;
    if (item >= params.count) {
        return;
    }
    vec3 d = inputs[item].xyz;
    float[SH9_COUNT] y = sh9_basis(d);
    outputs[item * 3u] = vec4(y[0], y[1], y[2], y[3]);
    outputs[item * 3u + 1u] = vec4(y[4], y[5], y[6], y[7]);
    outputs[item * 3u + 2u] = vec4(y[8], sh9_irradiance_over_pi(coefficients, d));
}
