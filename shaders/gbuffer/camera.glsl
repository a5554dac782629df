// The camera of src/instrument/scene/camera.rs from push constants. Camera space: x right, y up, z
// along the view, eye at 0.
#include "generated/layout.glsl"

// World to camera space. The eye is subtracted first: far from the origin a 4x4 matrix would lose
// digits.
vec3 camera_from_world(GbufferParams camera, vec3 position_world) {
    vec3 p = position_world - camera.eye.xyz;
    return vec3(dot(camera.right.xyz, p), dot(camera.up.xyz, p), dot(camera.forward.xyz, p));
}

// Rotates a camera-space vector into the world.
vec3 world_from_camera(GbufferParams camera, vec3 w) {
    return camera.right.xyz * w.x + camera.up.xyz * w.y + camera.forward.xyz * w.z;
}

// Clip coordinates (y down, depth 0 to 1) of a camera-space position.
vec4 clip_from_camera(GbufferParams camera, vec3 p) {
    float w = camera.eye.w > 0.0 ? p.z : 1.0;
    return vec4(p.x / camera.right.w, -p.y / camera.up.w, camera.forward.w * p.z + camera.depth_offset, w);
}

// The ray through `pixel` (gl_FragCoord.xy, so centres end in .5) in camera space; the direction is
// not a unit vector.
void camera_ray(GbufferParams camera, vec2 pixel, out vec3 origin, out vec3 direction) {
    vec2 size = vec2(camera.width, camera.height);
    // 2 pixel - size is exact in f32, so each coordinate is rounded twice only.
    vec2 plane = (2.0 * pixel - size) / size * vec2(camera.right.w, -camera.up.w);
    bool perspective = camera.eye.w > 0.0;
    origin = perspective ? vec3(0.0) : vec3(plane, 0.0);
    direction = perspective ? vec3(plane, 1.0) : vec3(0.0, 0.0, 1.0);
}
