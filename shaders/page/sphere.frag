// The g-buffer of one sphere if the pixel's ray hits it. Depth is the one of clip_from_camera, in
// [1/2, 1].
#include "page/gbuffer.glsl"
#include "gbuffer/intersect.glsl"

// Centre and radius.
uniform vec4 sphere;

void main() {
    vec3 origin, direction, hit;
    camera_ray(camera, gl_FragCoord.xy, origin, direction);
    vec3 center = camera_from_world(camera, sphere.xyz) - origin;
    if (!intersect_sphere(direction, center, sphere.w, hit)) {
        discard;
    }
    vec4 clip = clip_from_camera(camera, origin + center + hit);
    gl_FragDepth = 0.5 + 0.5 * clip.z / clip.w;
    vec3 hit_world = world_from_camera(camera, hit);
    vec3 n = normalize(hit_world);
    write_surface(sphere.xyz + hit_world, n, vec4(0.0), n);
}
