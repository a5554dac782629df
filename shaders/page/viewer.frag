// One texel of an image of the comparison: as display colour, or as error against its reference.
// Alpha is 0 if a channel is clipped, or the error beyond the colours' range. The target has the
// image's size, row 0 on top.
#include "page/display.glsl"

uniform sampler2D image;
uniform sampler2D reference;
uniform sampler2D mask;
// 0 image, 1 relative error, 2 signed error.
uniform int mode;
uniform vec3 off_mask_color;

out vec4 color;

// A display value from here on rounds to the 8-bit code 255.
const float CODE_255 = 254.5 / 255.0;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    vec3 radiance = texelFetch(image, texel, 0).rgb;
    if (mode == 0) {
        vec3 c = display(radiance);
        color = vec4(c, any(greaterThanEqual(c, vec3(CODE_255))) ? 0.0 : 1.0);
    } else if (texelFetch(mask, texel, 0).r == 0.0) {
        color = vec4(off_mask_color, 1.0);
    } else {
        color = error_color(radiance, texelFetch(reference, texel, 0).rgb, mode == 2);
    }
}
