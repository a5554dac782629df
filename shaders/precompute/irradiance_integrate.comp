// One invocation computes one texel of the irradiance map: irradiance over pi by the midpoint rule over the hemisphere,
//     E / pi = sum L cos(theta) sin(theta) / sum cos(theta) sin(theta),
// [source documents 1 and 4, bounds and normalisation corrected]
// each lookup from the level at which a texel covers the sample's cell. Radiance 1 gives 1.
// Set 0: 0 environment with its mips; 1 the map to write (rgba32f).
// Dispatch: ceil(width / GROUP_SIDE) x ceil(height / GROUP_SIDE) groups.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "generated/constants.glsl"
#include "generated/layout.glsl"
#include "lib/equirect.glsl"
#include "lib/frame.glsl"

layout(local_size_x = GROUP_SIDE, local_size_y = GROUP_SIDE) in;

layout(push_constant) uniform Push {
    IrradianceParams params;
};

layout(set = 0, binding = 0) uniform sampler2D environment;
layout(rgba32f, set = 0, binding = 1) uniform writeonly image2D irradiance_map;

void main() {
    uvec2 texel = gl_GlobalInvocationID.xy;
    uvec2 size = uvec2(params.width, params.height);
    if (texel.x >= size.x || texel.y >= size.y) {
        return;
    }
    mat3 frame = frame_from_normal(direction_from_uv(uv_from_texel(texel, size)));
    vec2 source_size = vec2(params.source_width, params.source_height);
    float lod_max = float(textureQueryLevels(environment) - 1);
    // Solid angle of a cell of the grid over sin(theta): dtheta dphi.
    float cell = (0.5 * PI / float(params.theta_count)) * (2.0 * PI / float(params.phi_count));

    vec3 sum = vec3(0.0);
    float weight_sum = 0.0;
    for (uint j = 0u; j < params.theta_count; ++j) {
        vec2 sin_cos_theta = sin_cos_turns(0.25 * (float(j) + 0.5) / float(params.theta_count));
        vec3 ring = vec3(0.0);
        for (uint i = 0u; i < params.phi_count; ++i) {
            vec2 sin_cos_phi = sin_cos_turns((float(i) + 0.5) / float(params.phi_count));
            vec3 l = frame * vec3(sin_cos_theta.x * sin_cos_phi.yx, sin_cos_theta.y);
            vec3 uv_sin_theta = uv_sin_theta_from_direction(l);
            float omega_p = texel_solid_angle(uv_sin_theta.z, source_size);
            float lod = clamp(lod_from_solid_angles(cell * sin_cos_theta.x, omega_p), 0.0, lod_max);
            ring += textureLod(environment, uv_sin_theta.xy, lod).rgb;
        }
        float weight = sin_cos_theta.x * sin_cos_theta.y;
        sum += weight * ring;
        weight_sum += weight;
    }
    imageStore(irradiance_map, ivec2(texel), vec4(sum / (weight_sum * float(params.phi_count)), 1.0));
}
