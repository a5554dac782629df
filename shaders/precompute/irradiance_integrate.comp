// One invocation computes one texel of the irradiance map: irradiance over pi by the midpoint rule
// over the hemisphere,
//     E / pi = sum L cos(theta) sin(theta) / sum cos(theta) sin(theta),
// [source documents 1 and 4, bounds and normalisation corrected] each lookup from the level at
// which a texel covers the sample's cell. Radiance 1 gives 1. Set 0: 0 the environment's filtered
// levels; 1 the map to write (rgba32f), a layer a face.

#include "lib/image_groups.glsl"
#include "lib/elementary.glsl"
#include "lib/filtering.glsl"
#include "lib/frame.glsl"
#include "selected/map_layout.glsl"

layout(push_constant) uniform Push {
    IrradianceParams params;
};

layout(set = 0, binding = 0) uniform FILTERED_MAP environment;
layout(rgba32f, set = 0, binding = 1) uniform writeonly image2DArray irradiance_map;

void main() {
    uvec3 texel = gl_GlobalInvocationID + uvec3(0u, params.first_row, 0u);
    uvec2 size = uvec2(params.width, params.height);
    if (texel.x >= size.x || texel.y >= size.y) {
        return;
    }
    mat3 frame = frame_from_normal(direction_from_texel(texel, vec2(0.5), vec2(size)));
    vec2 source_size = vec2(params.source_width, params.source_height);
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
            MapPlace place = map_place(l);
            float lod = lod_from_solid_angles(cell * sin_cos_theta.x, texel_solid_angle(place, source_size, cell * sin_cos_theta.x));
            ring += map_radiance(environment, place, max(lod, 0.0));
        }
        float weight = sin_cos_theta.x * sin_cos_theta.y;
        sum += weight * ring;
        weight_sum += weight;
    }
    imageStore(irradiance_map, ivec3(texel), vec4(sum / (weight_sum * float(params.phi_count)), 1.0));
}
