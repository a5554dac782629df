// One pixel of a half that is interpolated between texels. Set 0: window/half.glsl.
#include "window/half.glsl"

layout(location = 0) out vec4 display;

// Returns 256 times the mean of two texels of a row, whose second has a weight of 256.
uvec3 row_mean(uint first, uint second, uint row, uint weight) {
    return texel(first, row) * (256u - weight) + texel(second, row) * weight;
}

void main() {
    // Each operation is rounded once, as on the CPU.
    precise vec2 centre = texel_position(gl_FragCoord.xy);
    precise vec2 position = max(centre - 0.5, 0.0);
    uvec2 first = uvec2(position);
    uvec2 weight = uvec2((position - vec2(first)) * 256.0);
    uvec2 second = min(first + 1u, last_texel());
    first = min(first, last_texel());
    uvec3 upper = row_mean(first.x, second.x, first.y, weight.x);
    uvec3 lower = row_mean(first.x, second.x, second.y, weight.x);
    uvec3 sum = upper * ((256u - weight.y) * params.brightness)
              + lower * (weight.y * params.brightness);
    display = vec4(vec3(sum >> 24) / 255.0, 1.0);
}
