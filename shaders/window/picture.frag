// One pixel of a half in the window, in whole numbers as in src/view/stretch.rs.
// Set 0: 0 texels of the half's image, row-major, R in the lowest byte.
#include "generated/layout.glsl"

layout(push_constant) uniform Push { WindowPictureParams params; };

layout(std430, set = 0, binding = 0) readonly buffer Texels { uint texels[]; };

layout(location = 0) out vec4 display;

// The two texels that a pixel lies between, and the weight of the second, of 256.
struct Between {
    uint first;
    uint second;
    uint weight;
};

Between between(uint pixel, uint pixel_count, uint texel_count) {
    // The pixel's centre is at this over twice the number of pixels, in texels.
    uint centre = (2u * pixel + 1u) * texel_count;
    if (params.is_smooth == 1u) {
        centre -= min(centre, pixel_count);
    }
    uint first = centre / (2u * pixel_count);
    uint rest = centre % (2u * pixel_count);
    uint last = texel_count - 1u;
    uint weight = params.is_smooth == 1u ? 128u * rest / pixel_count : 0u;
    return Between(min(first, last), min(first + 1u, last), weight);
}

uvec3 texel(uint column, uint row) {
    uint rgba = texels[row * params.texel_columns + column];
    return uvec3(rgba, rgba >> 8, rgba >> 16) & 0xffu;
}

// Returns 256 times the weighted mean of two texels of a row.
uvec3 row_mean(Between across, uint row) {
    return texel(across.first, row) * (256u - across.weight)
         + texel(across.second, row) * across.weight;
}

void main() {
    uvec2 pixel = uvec2(gl_FragCoord.xy) - uvec2(params.left, params.top);
    Between across = between(pixel.x, params.width, params.texel_columns);
    Between down = between(pixel.y, params.height, params.texel_rows);
    uvec3 sum = row_mean(across, down.first) * ((256u - down.weight) * params.brightness)
              + row_mean(across, down.second) * (down.weight * params.brightness);
    display = vec4(vec3(sum >> 24) / 255.0, 1.0);
}
