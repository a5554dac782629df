// A shader of known size, for the test of the counter of instructions: so many products and lookups
// before a loop, so many within it. Set 0: 0 any map; 1 the result, a vec4 an invocation. Dispatch:
// any.

layout(local_size_x = 64) in;

layout(constant_id = 0) const uint PRODUCTS_OUTSIDE = 0u;
layout(constant_id = 1) const uint PRODUCTS_INSIDE = 0u;
layout(constant_id = 2) const uint LOOKUPS_OUTSIDE = 0u;
layout(constant_id = 3) const uint LOOKUPS_INSIDE = 0u;
layout(constant_id = 4) const uint ROOTS_INSIDE = 0u;

layout(push_constant) uniform Push {
    uint count;
};
layout(set = 0, binding = 0) uniform sampler2D map;
layout(std430, set = 0, binding = 1) buffer Result {
    vec4 result[];
};

void main() {
    precise float x = float(gl_GlobalInvocationID.x);
    for (uint i = 0u; i < PRODUCTS_OUTSIDE; ++i) {
        x *= x;
    }
    vec4 sum = vec4(x);
    for (uint i = 0u; i < LOOKUPS_OUTSIDE; ++i) {
        sum += textureLod(map, vec2(x, float(i)), 0.0);
    }
    for (uint k = 0u; k < count; ++k) {
        precise float y = x + float(k);
        for (uint i = 0u; i < PRODUCTS_INSIDE; ++i) {
            y *= y;
        }
        for (uint i = 0u; i < ROOTS_INSIDE; ++i) {
            y = sqrt(y);
        }
        for (uint i = 0u; i < LOOKUPS_INSIDE; ++i) {
            sum += textureLod(map, vec2(y, float(i)), y);
        }
        sum += y;
    }
    result[gl_GlobalInvocationID.x] = sum;
}
