// Split sums of an anisotropic lobe by equal lookups along its major axis;
// src/instrument/shade/method/split_sum_major.rs has the formula.
#pragma methods split-sum-major-two split-sum-major-four

#include "lib/split_sum.glsl"

#if defined(SPLIT_SUM_MAJOR_TWO)
const uint MAJOR_COUNT = 2u;
#else
const uint MAJOR_COUNT = 4u;
#endif

vec3 specular_radiance(Surface s) {
    mat3 frame = frame_of_surface(s);
    vec3 v = vec3((s.v * frame).xy, s.n_dot_v);
    vec2 radii = sqrt(0.5) * s.width;
    vec2 scale = inversesqrt(1.0 + radii * radii);
    vec2 stretched = radii * scale;
    vec2 squares = stretched * stretched * (1.0 - v.yx * v.yx);
    float shear = 2.0 * stretched.x * stretched.y * v.x * v.y;
    float gap = squares.x - squares.y;
    float turn = shear == 0.0 && gap == 0.0 ? 0.0 : 0.5 * atan(shear, gap);
    vec2 major = normalize(scale * vec2(cos(turn), sin(turn)));
    vec2 minor = normalize(scale * vec2(-sin(turn), cos(turn)));
    if (dot(radii * major, v.xy) < 0.0) {
        major = -major;
    }
    vec2 slope = radii * major;
    float along = dot(slope, v.xy);
    // A grazing view across the axis has no light above the horizon but about n.
    float reach = max(along + sqrt(along * along + v.z * v.z * dot(slope, slope)), COSINE_MIN * COSINE_MIN);
    float end = max(-v.z / reach, -1.0);
    vec3 from = normalize(vec3(end * slope, 1.0));
    vec3 to = normalize(vec3(slope, 1.0));
    float moved = 0.5 * (1.0 + end) * acos(min(abs(dot(major, minor)), 1.0));
    vec2 aside = vec2(-minor.y, minor.x);
    aside *= sin(moved) * (dot(aside, major) < 0.0 ? -1.0 : 1.0);
    vec3 left = normalize(vec3(radii * (aside + cos(moved) * minor), 1.0));
    vec3 right = normalize(vec3(radii * (aside - cos(moved) * minor), 1.0));
    float long_axis = distance(reflect(-v, from), reflect(-v, to));
    float short_axis = distance(reflect(-v, left), reflect(-v, right));
    vec3 centre = normalize(from + to);
    float share = 1.0 - short_axis / long_axis;
    from = normalize(mix(centre, from, share));
    to = normalize(mix(centre, to, share));
    float alpha = clamp(0.5 * max(short_axis, MAJOR_SPACING * long_axis / float(MAJOR_COUNT)), ALPHA_MIN, 1.0);
    float perceptual_roughness = perceptual_roughness_from_alpha(alpha);
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < MAJOR_COUNT; ++i) {
        vec3 normal = normalize(mix(from, to, float(i) / float(MAJOR_COUNT - 1u)));
        sum += prefiltered_radiance(frame * normalize(reflect(-v, normal)), perceptual_roughness);
    }
    return sum / float(MAJOR_COUNT) * reflectance(s);
}
