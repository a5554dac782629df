#version 300 es
// One pixel of the comparison: the texel under it, as display colour or as error against the reference.
precision highp float;
precision highp int;
precision highp sampler2D;

#include "tone_curve.glsl"

uniform sampler2D left_image;
uniform sampler2D right_image;
uniform sampler2D left_reference;
uniform sampler2D right_reference;
uniform sampler2D mask;
// Row 0 magma, row 1 blue-red.
uniform sampler2D palette;
uniform vec2 canvas_size;
// Texel at the canvas' top left corner, and canvas pixels a texel.
uniform vec2 origin;
uniform float scale;
// Canvas column from which the right image is shown.
uniform float split;
// 0 image, 1 relative error, 2 signed error.
uniform int mode;
// 0 the project's tone curve, 1 plain sRGB.
uniform int tone;
uniform float exposure;
uniform float contrast;
uniform bool shows_clipped;
uniform vec2 relative_range;
uniform vec2 signed_range;
uniform vec3 nan_color;
uniform vec3 off_mask_color;
uniform vec3 background;

out vec4 color;

// The epsilon of relmse_eps1e-2.
const float EPSILON = 1e-2;
const float STRIPE_PIXELS = 5.0;
// A display value from here on rounds to the 8-bit code 255.
const float CODE_255 = 254.5 / 255.0;

vec3 srgb_encode(vec3 linear) {
    vec3 c = clamp(linear, 0.0, 1.0);
    return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, 12.92 * c, lessThanEqual(c, vec3(0.0031308)));
}

vec3 display(vec3 radiance) {
    return tone == 0 ? tone_curve(radiance, exposure, contrast) : srgb_encode(radiance * exposure);
}

vec3 palette_color(float place, int row) {
    float x = clamp(place, 0.0, 1.0) * 255.0;
    int lower = min(int(x), 254);
    return mix(texelFetch(palette, ivec2(lower, row), 0).rgb, texelFetch(palette, ivec2(lower + 1, row), 0).rgb,
               x - float(lower));
}

// The formulas of the columns err_p95 ... and relmse_eps1e-2.
vec3 error_color(vec3 t, vec3 r) {
    vec3 relative = (t - r) / sqrt(r * r + EPSILON);
    if (any(isnan(relative))) return nan_color;
    if (mode == 1) {
        float e = sqrt(dot(relative, relative) / 3.0);
        return palette_color(log(max(e, relative_range.x) / relative_range.x) / log(relative_range.y / relative_range.x), 0);
    }
    float mean = dot(relative, vec3(1.0 / 3.0));
    return palette_color((mean - signed_range.x) / (signed_range.y - signed_range.x), 1);
}

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
        color = vec4(error_color(radiance, reference), 1.0);
    }
}
