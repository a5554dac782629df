// One pixel of the live view's canvas: a specular term, its error against the reference, or the
// linear value.
#include "page/display.glsl"

uniform sampler2D gbuffer_position;
// The diffuse term, and the environment, beside each specular term.
uniform sampler2D test_surround;
uniform sampler2D test;
uniform sampler2D truth_surround;
uniform sampler2D truth;
// All samples over those that are in the texture so far.
uniform float test_share;
uniform float truth_share;
// 0 image, 1 relative error, 2 signed error.
uniform int mode;
// Writes the linear radiance of the test, row 0 on top.
uniform bool is_linear;
// Of the canvas, whose row 0 is at the bottom.
uniform float canvas_height;
uniform vec3 off_mask_color;

out vec4 color;

void main() {
    vec2 pixel = is_linear ? gl_FragCoord.xy : vec2(gl_FragCoord.x, canvas_height - gl_FragCoord.y);
    ivec2 texel = ivec2(pixel);
    vec3 t = texelFetch(test_surround, texel, 0).rgb + test_share * texelFetch(test, texel, 0).rgb;
    float is_hit = texelFetch(gbuffer_position, texel, 0).w;
    if (is_linear) {
        color = vec4(t, is_hit);
    } else if (mode == 0) {
        color = vec4(display(t), 1.0);
    } else if (is_hit == 0.0) {
        color = vec4(off_mask_color, 1.0);
    } else {
        vec3 r = texelFetch(truth_surround, texel, 0).rgb + truth_share * texelFetch(truth, texel, 0).rgb;
        color = vec4(error_color(t, r, mode == 2).rgb, 1.0);
    }
}
