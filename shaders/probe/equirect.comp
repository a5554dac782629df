// One invocation evaluates the functions of lib/equirect.glsl for one item.
// In: (unit direction, omega_s), (u, v, width, height).
// Out: (uv of the direction, sin(theta), texel solid angle there), (direction of uv, lod).
// Set 0: 0 inputs, 2 vec4 an item; 1 outputs, 2 vec4 an item.

#include "lib/equirect.glsl"
#include "lib/filtering.glsl"
#include "probe/item.glsl"

void main() {
    uint item = gl_GlobalInvocationID.x;
    if (item >= params.count) {
        return;
    }
    vec4 direction_omega_s = inputs[item * 2u];
    vec4 uv_size = inputs[item * 2u + 1u];
    vec3 uv_sin_theta = uv_sin_theta_from_direction(direction_omega_s.xyz);
    float omega_p = texel_solid_angle(uv_sin_theta.z, uv_size.zw);
    outputs[item * 2u] = vec4(uv_sin_theta, omega_p);
    outputs[item * 2u + 1u] = vec4(direction_from_uv(uv_size.xy), lod_from_solid_angles(direction_omega_s.w, omega_p));
}
