// One pixel of the canvas of the live view: split sum, sampled, or the error of the first against the second; or the linear value itself.
#include "page/display.glsl"

uniform sampler2D gbuffer_position;
uniform sampler2D surround;
uniform sampler2D split_sum;
uniform sampler2D sampled;
// 0 split sum, 1 sampled, 2 relative error, 3 signed error.
uniform int mode;
// All samples over those that are in `sampled` so far.
uniform float sample_share;
// Writes the linear radiance of mode 0 or 1, row 0 on top.
uniform bool is_linear;
// Canvas pixels a side of a drawn pixel, and the canvas' height.
uniform float pixel_side;
uniform float canvas_height;
uniform vec3 off_mask_color;

out vec4 color;

void main() {
    vec2 pixel = is_linear ? gl_FragCoord.xy : vec2(gl_FragCoord.x, canvas_height - gl_FragCoord.y);
    ivec2 texel = min(ivec2(pixel / pixel_side), textureSize(surround, 0) - 1);
    vec3 base = texelFetch(surround, texel, 0).rgb;
    vec3 fast = base + texelFetch(split_sum, texel, 0).rgb;
    vec3 slow = base + sample_share * texelFetch(sampled, texel, 0).rgb;
    if (is_linear) {
        color = vec4(mode == 0 ? fast : slow, 1.0);
    } else if (mode < 2) {
        color = vec4(display(mode == 0 ? fast : slow), 1.0);
    } else if (texelFetch(gbuffer_position, texel, 0).w == 0.0) {
        color = vec4(off_mask_color, 1.0);
    } else {
        color = vec4(error_color(fast, slow, mode == 3).rgb, 1.0);
    }
}
