// Limits of real hardware, emulated for tests. The first text of every shader of the program.
// EMULATED_LIMITS holds bits EMULATE_*; with 0, the default, each function here is the built-in one,
// and the compiler leaves nothing of this file.
//
// A built-in function is replaced by a macro of its name. A macro does not expand within itself, and
// the functions below stand before it.

#include "generated/constants.glsl"
#include "generated/specialization/emulated_limits.glsl"

// The least precision of a texel's weight and of the part between two levels that Vulkan allows and
// GPUs have: 8 bits.
const float FRACTION_STEPS = 256.0;

bool emulates(uint limit) {
    return (EMULATED_LIMITS & limit) != 0u;
}

// A texel position (in texels from the first centre) whose bilinear weights are multiples of 1/256
// if the device emulates that, to nearest or rounded down.
vec2 position_of_weights(vec2 position) {
    vec2 corner = floor(position), steps = (position - corner) * FRACTION_STEPS;
    if (emulates(EMULATE_TEXEL_WEIGHTS_DOWN)) {
        return corner + floor(steps) / FRACTION_STEPS;
    }
    return emulates(EMULATE_TEXEL_WEIGHTS) ? corner + round(steps) / FRACTION_STEPS : position;
}

// The level's side lengths. textureSize of several levels at once is wrong on some drivers.
vec2 size_of_level(ivec2 size, float level) {
    return vec2(max(size >> int(level), ivec2(1)));
}

vec4 limited_level(sampler2D map, vec2 uv, float level) {
    if (emulates(EMULATE_TEXEL_WEIGHTS | EMULATE_TEXEL_WEIGHTS_DOWN)) {
        vec2 size = size_of_level(textureSize(map, 0), level);
        uv = (position_of_weights(uv * size - 0.5) + 0.5) / size;
    }
    return textureLod(map, uv, level);
}

// The axes of the face that a direction meets: its normal, then the two along its sides.
uvec3 axes_of_face(vec3 d) {
    vec3 a = abs(d);
    uint major = a.x >= a.y && a.x >= a.z ? 0u : a.y >= a.z ? 1u : 2u;
    return uvec3(major, (major + 1u) % 3u, (major + 2u) % 3u);
}

// Where three faces meet, a lookup has three texels. Vulkan leaves the weight of the fourth open:
// lavapipe averages the three; here the face's own texel takes it. `d` is on the face of `axes`, and
// `beyond` says how far (in texels) it is outside the centres of that face, along both sides.
vec4 level_at_corner(samplerCube map, vec3 d, uvec3 axes, vec2 beyond, vec2 size, float level) {
    vec2 last_centre = 1.0 - 1.0 / size;
    vec3 own = d;
    own[axes.y] = sign(d[axes.y]) * last_centre.x;
    own[axes.z] = sign(d[axes.z]) * last_centre.y;
    vec3 across_first = own, across_second = own;
    across_first[axes.x] = d[axes.x] * last_centre.x;
    across_first[axes.y] = sign(d[axes.y]);
    across_second[axes.x] = d[axes.x] * last_centre.y;
    across_second[axes.z] = sign(d[axes.z]);
    float first_weight = beyond.x * (1.0 - beyond.y), second_weight = (1.0 - beyond.x) * beyond.y;
    return (1.0 - first_weight - second_weight) * textureLod(map, own, level)
        + first_weight * textureLod(map, across_first, level)
        + second_weight * textureLod(map, across_second, level);
}

vec4 limited_level(samplerCube map, vec3 d, float level) {
    uvec3 axes = axes_of_face(d);
    vec2 size = size_of_level(textureSize(map, 0), level);
    vec2 position = (0.5 * vec2(d[axes.y], d[axes.z]) / abs(d[axes.x]) + 0.5) * size - 0.5;
    position = position_of_weights(position);
    vec2 within = clamp(position, vec2(0.0), size - 1.0);
    if (emulates(EMULATE_CUBE_SEAMS)) {
        position = within;
    }
    vec2 inside = 2.0 * (position + 0.5) / size - 1.0;
    d[axes.y] = inside.x;
    d[axes.z] = inside.y;
    d[axes.x] = d[axes.x] < 0.0 ? -1.0 : 1.0;
    vec2 beyond = abs(position - within);
    if (emulates(EMULATE_CUBE_CORNERS) && min(beyond.x, beyond.y) > 0.0) {
        return level_at_corner(map, d, axes, beyond, size, level);
    }
    return textureLod(map, d, level);
}

vec4 limited_value(vec4 value) {
    if (emulates(EMULATE_HALF_LOOKUPS)) {
        value = vec4(unpackHalf2x16(packHalf2x16(value.xy)), unpackHalf2x16(packHalf2x16(value.zw)));
    }
    return value;
}

// Defines the lookup of one type of sampler: two levels, each with the limits of its texels.
#define DEFINE_LIMITED_LOOKUP(Sampler, Coordinates)                                                    \
    vec4 limited_lookup(Sampler map, Coordinates at, float lod) {                                      \
        if (!emulates(EMULATE_LOOKUPS)) {                                                              \
            return textureLod(map, at, lod);                                                           \
        }                                                                                              \
        float last = float(textureQueryLevels(map) - 1);                                               \
        float level = clamp(lod, 0.0, last);                                                           \
        float fine = floor(level), part = level - fine;                                                \
        if (emulates(EMULATE_LEVEL_FRACTIONS)) {                                                       \
            part = round(part * FRACTION_STEPS) / FRACTION_STEPS;                                      \
        }                                                                                              \
        vec4 value = limited_level(map, at, fine);                                                     \
        if (part > 0.0) {                                                                              \
            value = mix(value, limited_level(map, at, min(fine + 1.0, last)), part);                   \
        }                                                                                              \
        return limited_value(value);                                                                   \
    }

DEFINE_LIMITED_LOOKUP(sampler2D, vec2)
DEFINE_LIMITED_LOOKUP(samplerCube, vec3)

// A number in [-1, 1] from a value's bits, as an error that no fit can undo.
float error_from_bits(float value) {
    uint bits = floatBitsToUint(value) * 747796405u + 2891336453u;
    bits = ((bits >> ((bits >> 28u) + 4u)) ^ bits) * 277803737u;
    return float((bits >> 22u) ^ (bits & 0x3ffu)) * (2.0 / 1023.0) - 1.0;
}

// A value that is wrong by at most `ulp` units in the last place. 0 and infinity are exact: the logarithm
// of 0, of which pow(0, y) is made, must stay infinite.
float limited_elementary(float value, float ulp) {
    bool is_exact = !emulates(EMULATE_ELEMENTARY) || value == 0.0 || isinf(value);
    return is_exact ? value : value + value * (ulp * 1.1920929e-7 * error_from_bits(value));
}

// Vulkan's limits (section "Precision and Operation of SPIR-V Instructions"), in ULP.
float limited_sqrt(float x) { return limited_elementary(sqrt(x), 4.5); }
float limited_inversesqrt(float x) { return limited_elementary(inversesqrt(x), 2.0); }
float limited_exp2(float x) { return limited_elementary(exp2(x), 3.0 + 2.0 * abs(x)); }
float limited_exp(float x) { return limited_elementary(exp(x), 3.0 + 2.0 * abs(x)); }
// Next to 1 the limit is an absolute one, 2^-21.
float limited_log2(float x) { return limited_elementary(log2(x), x >= 0.5 && x <= 2.0 ? 4.0 / max(abs(log2(x)), 1e-6) : 3.0); }
float limited_log(float x) { return emulates(EMULATE_ELEMENTARY) ? 0.69314718 * limited_log2(x) : log(x); }
float limited_pow(float x, float y) { return emulates(EMULATE_ELEMENTARY) ? limited_exp2(y * limited_log2(x)) : pow(x, y); }

// An absolute error of 2^-11 is allowed in [-pi, pi].
float limited_turn(float value) {
    return emulates(EMULATE_ELEMENTARY) ? value + 4.8828125e-4 * error_from_bits(value) : value;
}

float limited_sin(float x) { return limited_turn(sin(x)); }
float limited_cos(float x) { return limited_turn(cos(x)); }

// The same for vectors.
#define DEFINE_FOR_VECTORS(function)                                              \
    vec2 function(vec2 x) { return vec2(function(x.x), function(x.y)); }          \
    vec3 function(vec3 x) { return vec3(function(x.x), function(x.y), function(x.z)); }

DEFINE_FOR_VECTORS(limited_sqrt)
DEFINE_FOR_VECTORS(limited_inversesqrt)
DEFINE_FOR_VECTORS(limited_exp2)
DEFINE_FOR_VECTORS(limited_exp)
DEFINE_FOR_VECTORS(limited_log2)
DEFINE_FOR_VECTORS(limited_log)
DEFINE_FOR_VECTORS(limited_sin)
DEFINE_FOR_VECTORS(limited_cos)

vec3 limited_pow(vec3 x, vec3 y) {
    return vec3(limited_pow(x.x, y.x), limited_pow(x.y, y.y), limited_pow(x.z, y.z));
}

// A vertex on the grid of a rasteriser that keeps 8 bits of a pixel's fraction.
vec4 limited_vertex(vec4 clip, vec2 size) {
    if (emulates(EMULATE_VERTEX_GRID)) {
        vec2 pixel = (clip.xy / clip.w) * 0.5 * size;
        clip.xy = round(pixel * FRACTION_STEPS) / FRACTION_STEPS / (0.5 * size) * clip.w;
    }
    return clip;
}

// exp2 keeps its name: shaders use it for constants alone, which the compiler computes.
#define textureLod(map, at, lod) limited_lookup(map, at, lod)
#define sqrt(x) limited_sqrt(x)
#define inversesqrt(x) limited_inversesqrt(x)
#define exp(x) limited_exp(x)
#define log2(x) limited_log2(x)
#define log(x) limited_log(x)
#define pow(x, y) limited_pow(x, y)
#define sin(x) limited_sin(x)
#define cos(x) limited_cos(x)
