#version 460
// The g-buffer texels of one mesh, shaded on both sides.
// Set 0: binding 1 materials, binding 2 albedo map (1x1 white without one; repeating, linear, one level).
// Push constants: GbufferParams. Front faces are counter-clockwise; nothing is culled.
#extension GL_GOOGLE_include_directive : require
#include "gbuffer/surface.glsl"

layout(set = 0, binding = 1, std430) readonly buffer Materials { MaterialData materials[]; };
layout(set = 0, binding = 2) uniform sampler2D albedo_map;
layout(push_constant) uniform Params { GbufferParams camera; };

layout(location = 0) in vec3 position_world;
layout(location = 1) in vec3 normal_world;
layout(location = 2) in vec2 uv_up;

layout(location = 0) out vec4 position_mask;
layout(location = 1) out vec4 normal_alpha;
layout(location = 2) out vec4 albedo_metallic;
layout(location = 3) out vec4 f0_material;

void main() {
    // Winding and normals agree (scene::Mesh), so a back face is one whose normal points to the far side of the surface.
    vec3 n = normalize(gl_FrontFacing ? normal_world : -normal_world);
    // OBJ counts v from the bottom row, the image from the top row. Level 0 always: one sample through the pixel's centre, as the twin takes it.
    vec3 albedo = textureLod(albedo_map, vec2(uv_up.x, 1.0 - uv_up.y), 0.0).rgb;
    GbufferTexels texels = gbuffer_texels(position_world, n, materials[camera.material], albedo, camera.material);
    position_mask = texels.position_mask;
    normal_alpha = texels.normal_alpha;
    albedo_metallic = texels.albedo_metallic;
    f0_material = texels.f0_material;
}
