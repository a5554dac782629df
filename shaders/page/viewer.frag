// One pixel of the comparison: the texel under it, as display colour or as error against the reference.
#include "page/display.glsl"

uniform sampler2D left_image;
uniform sampler2D right_image;
uniform sampler2D left_reference;
uniform sampler2D right_reference;
uniform sampler2D mask;
uniform vec2 canvas_size;
// Texel at the canvas' top left corner, and canvas pixels a texel.
uniform vec2 origin;
uniform float scale;
// Canvas column from which the right image is shown.
uniform float split;
// 0 image, 1 relative error, 2 signed error.
uniform int mode;
uniform bool shows_clipped;
uniform vec3 off_mask_color;
uniform vec3 background;

out vec4 color;

const float STRIPE_PIXELS = 5.0;
// A display value from here on rounds to the 8-bit code 255.
const float CODE_255 = 254.5 / 255.0;

void main() {
    vec2 pixel = vec2(gl_FragCoord.x, canvas_size.y - gl_FragCoord.y);
    ivec2 texel = ivec2(floor(pixel / scale + origin));
    ivec2 size = textureSize(left_image, 0);
    if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, size))) {
        color = vec4(background, 1.0);
        return;
    }
    bool is_right = pixel.x >= split;
    vec3 radiance = is_right ? texelFetch(right_image, texel, 0).rgb : texelFetch(left_image, texel, 0).rgb;
    vec3 reference = is_right ? texelFetch(right_reference, texel, 0).rgb : texelFetch(left_reference, texel, 0).rgb;
    if (mode == 0) {
        vec3 c = display(radiance);
        bool is_high = any(greaterThanEqual(c, vec3(CODE_255)));
        if (shows_clipped && is_high && mod(pixel.x + pixel.y, 2.0 * STRIPE_PIXELS) < STRIPE_PIXELS) c = vec3(1.0, 0.0, 0.9);
        color = vec4(c, 1.0);
    } else if (texelFetch(mask, texel, 0).r == 0.0) {
        color = vec4(off_mask_color, 1.0);
    } else {
        color = vec4(error_color(radiance, reference, mode == 2), 1.0);
    }
}
