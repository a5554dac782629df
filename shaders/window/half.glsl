// Texels of a half in the window, by the same operations as in src/view/canvas.rs.
// Set 0: 0 texels of the half's image, row-major, R in the lowest byte.
#include "generated/layout.glsl"

layout(push_constant) uniform Push { WindowPictureParams params; };

layout(std430, set = 0, binding = 0) readonly buffer Texels { uint texels[]; };

// Returns the place of a pixel's centre, in texels.
vec2 texel_position(vec2 frag_coord) {
    return (frag_coord - vec2(params.left, params.top)) * vec2(params.across, params.down);
}

uvec2 last_texel() {
    return uvec2(params.texel_columns, params.texel_rows) - 1u;
}

uvec3 texel(uint column, uint row) {
    uint rgba = texels[row * params.texel_columns + column];
    return uvec3(rgba, rgba >> 8, rgba >> 16) & 0xffu;
}
