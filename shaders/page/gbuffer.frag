// The g-buffer of the live view: the sphere and the rectangle where the ray through the pixel's centre meets them.
// Row 0 of every target of the live view is the image's top row, as in the renderer.
#include "gbuffer/camera.glsl"
#include "gbuffer/intersect.glsl"
#include "gbuffer/surface.glsl"
#include "lib/prefilter_mapping.glsl"

uniform GbufferParams camera;
// All but alpha, which follows from the roughness.
uniform MaterialData material;
uniform float perceptual_roughness;
// Centre and radius; radius 0: no sphere.
uniform vec4 sphere;
// Height of a horizontal rectangle about the y axis, half its sides in x and z; 0: no rectangle.
uniform vec3 rectangle;

layout(location = 0) out vec4 position_mask;
layout(location = 1) out vec4 normal_alpha;
layout(location = 2) out vec4 albedo_metallic;
layout(location = 3) out vec4 f0_material;

void main() {
    vec3 origin, direction;
    camera_ray(camera, gl_FragCoord.xy, origin, direction);
    float nearest = 0.0;
    vec3 position = vec3(0.0);
    vec3 n = vec3(0.0);

    vec3 hit;
    vec3 center = camera_from_world(camera, sphere.xyz) - origin;
    if (sphere.w > 0.0 && intersect_sphere(direction, center, sphere.w, hit)) {
        vec3 hit_world = world_from_camera(camera, hit);
        position = sphere.xyz + hit_world;
        n = normalize(hit_world);
        nearest = dot(direction, center + hit);
    }
    vec3 origin_world = camera.eye.xyz + world_from_camera(camera, origin);
    vec3 direction_world = world_from_camera(camera, direction);
    // Distance in units of the direction's length; infinite or NaN where the ray is parallel, which no comparison below accepts.
    float t = (rectangle.x - origin_world.y) / direction_world.y;
    vec3 on_plane = origin_world + t * direction_world;
    bool is_inside = all(lessThanEqual(abs(on_plane.xz), rectangle.yz)) && t > 0.0 && rectangle.y > 0.0;
    float along = t * dot(direction, direction);
    if (is_inside && (nearest == 0.0 || along < nearest)) {
        position = vec3(on_plane.x, rectangle.x, on_plane.z);
        // Both sides are shaded.
        n = vec3(0.0, direction_world.y < 0.0 ? 1.0 : -1.0, 0.0);
        nearest = along;
    }
    if (nearest == 0.0) {
        position_mask = vec4(0.0);
        normal_alpha = vec4(0.0);
        albedo_metallic = vec4(0.0);
        f0_material = vec4(0.0);
        return;
    }
    MaterialData own = material;
    own.f0_alpha.a = alpha_from_perceptual_roughness(perceptual_roughness);
    GbufferTexels texels = gbuffer_texels(position, n, own, vec3(1.0), 0u);
    position_mask = texels.position_mask;
    normal_alpha = texels.normal_alpha;
    albedo_metallic = texels.albedo_metallic;
    f0_material = texels.f0_material;
}
