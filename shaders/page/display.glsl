// Linear radiance as a display colour, and errors in the project's colours: shared by all pictures
// of the page.

#include "lib/tone_curve.glsl"

// Row 0 magma, row 1 blue-red.
uniform sampler2D palette;
uniform vec2 relative_range;
uniform vec2 signed_range;
uniform vec3 nan_color;
// 0 the project's tone curve, 1 plain sRGB.
uniform int tone;
uniform float exposure;
uniform float contrast;

// Mean luminance of the light, which determines epsilon (metrics::Epsilon). Divided by first: its
// square may overflow.
uniform float light_mean;
const float EPSILON_SHARE = 1e-2;

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

// The root of the term of relmse. Alpha is 0 if the error is above the range of the colours or not
// a number.
vec4 error_color(vec3 t, vec3 r, bool is_signed) {
    vec3 share = r / light_mean;
    vec3 relative = (t - r) / light_mean / sqrt(share * share + EPSILON_SHARE);
    if (any(isnan(relative))) return vec4(nan_color, 0.0);
    if (!is_signed) {
        float e = sqrt(dot(relative, relative) / 3.0);
        float place = log(max(e, relative_range.x) / relative_range.x) / log(relative_range.y / relative_range.x);
        return vec4(palette_color(place, 0), e > relative_range.y ? 0.0 : 1.0);
    }
    float mean = dot(relative, vec3(1.0 / 3.0));
    bool is_beyond = mean < signed_range.x || mean > signed_range.y;
    return vec4(palette_color((mean - signed_range.x) / (signed_range.y - signed_range.x), 1), is_beyond ? 0.0 : 1.0);
}
