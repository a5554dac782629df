// The split sum about the mean visible normal; src/instrument/shade/method/split_sum_cap.rs has the
// formula.

#include "lib/cap_direction.glsl"
#include "lib/split_sum.glsl"

vec3 specular_radiance(Surface s) {
    vec2 a_b = albedo_pair(s);
    vec3 direction = cap_direction(s.n, s.v, s.n_dot_v, s.alpha, share_of_f90(s, a_b));
    return prefiltered_radiance(direction, perceptual_roughness_from_alpha(s.alpha)) * (s.f0 * a_b.x + a_b.y);
}
