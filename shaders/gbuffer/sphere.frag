// The g-buffer texels of one sphere if the ray through the pixel's centre hits it; misses are
// discarded. Set 0: binding 0 spheres, binding 1 materials. Push constants: GbufferParams.
#include "gbuffer/camera.glsl"
#include "gbuffer/intersect.glsl"
#include "gbuffer/surface.glsl"

layout(set = 0, binding = 0, std430) readonly buffer Spheres { SphereData spheres[]; };
layout(set = 0, binding = 1, std430) readonly buffer Materials { MaterialData materials[]; };
layout(push_constant) uniform Params { GbufferParams camera; };

layout(location = 0) flat in uint sphere_index;

layout(location = 0) out vec4 position_mask;
layout(location = 1) out vec4 normal_alpha;
layout(location = 2) out vec4 albedo_metallic;
layout(location = 3) out vec4 f0_material;

void main() {
    SphereData sphere = spheres[sphere_index];
    vec3 origin, direction;
    camera_ray(camera, gl_FragCoord.xy, origin, direction);
    vec3 center = camera_from_world(camera, sphere.center_radius.xyz) - origin;
    vec3 hit;
    if (!intersect_sphere(direction, center, sphere.center_radius.w, hit)) {
        discard;
    }
    vec4 clip = clip_from_camera(camera, origin + center + hit);
    gl_FragDepth = clip.z / clip.w;

    vec3 hit_world = world_from_camera(camera, hit);
    uint material_index = sphere.material.x;
    MaterialData material = materials[material_index];
    vec3 n = normalize(hit_world);
    if (material.tangent.w != 0.0) {
        n = from_tangent_frame(vec3(material.tangent.xy, 0.0), vec4(east(n), 1.0), n);
        material.f0_alpha.a = material.tangent.z;
    }
    GbufferTexels texels = gbuffer_texels(sphere.center_radius.xyz + hit_world, n, material, material_index);
    position_mask = texels.position_mask;
    normal_alpha = texels.normal_alpha;
    albedo_metallic = texels.albedo_metallic;
    f0_material = texels.f0_material;
}
