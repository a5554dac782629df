// One texel of a picture of what an image is made of, as display colour. Alpha is 0 if a channel of
// radiance is clipped. The target has the picture's size, row 0 on top.
#include "page/display.glsl"

uniform sampler2D image;
uniform sampler2D mask;
// 0 radiance by the tone curve, 1 a colour encoded as sRGB, 2 the extent from low to high, linear.
uniform int encoding;
uniform vec3 low;
uniform vec3 high;
uniform vec3 off_mask_color;

out vec4 color;

// A display value from here on rounds to the 8-bit code 255.
const float CODE_255 = 254.5 / 255.0;

// Where a value lies, 0 to 1; the middle in an extent of one value.
float share(float value, float least, float largest) {
    return largest > least ? clamp((value - least) / (largest - least), 0.0, 1.0) : 0.5;
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    vec3 value = texelFetch(image, texel, 0).rgb;
    // A picture with values everywhere has a mask of one texel.
    if (texelFetch(mask, min(texel, textureSize(mask, 0) - 1), 0).r == 0.0) {
        color = vec4(off_mask_color, 1.0);
    } else if (encoding == 0) {
        vec3 c = display(value);
        color = vec4(c, any(greaterThanEqual(c, vec3(CODE_255))) ? 0.0 : 1.0);
    } else if (encoding == 1) {
        color = vec4(srgb_encode(value), 1.0);
    } else {
        color = vec4(share(value.r, low.r, high.r), share(value.g, low.g, high.g), share(value.b, low.b, high.b), 1.0);
    }
}
