// One corner of the rectangle that encloses one sphere in the image.
// Set 0: binding 0 spheres. Push constants: GbufferParams.
// Draw: 4 vertices as a triangle strip, one instance a sphere.
#include "gbuffer/camera.glsl"
#include "gbuffer/intersect.glsl"

layout(set = 0, binding = 0, std430) readonly buffer Spheres { SphereData spheres[]; };
layout(push_constant) uniform Params { GbufferParams camera; };

layout(location = 0) flat out uint sphere_index;

void main() {
    sphere_index = gl_InstanceIndex;
    vec4 center_radius = spheres[gl_InstanceIndex].center_radius;
    vec3 c = camera_from_world(camera, center_radius.xyz);
    float r = center_radius.w;
    vec2 x = vec2(c.x - r, c.x + r);
    vec2 y = vec2(c.y - r, c.y + r);
    if (camera.eye.w > 0.0) {
        x = tangent_slopes(c.x, c.z, r);
        y = tangent_slopes(c.y, c.z, r);
    }
    vec2 low = vec2(x[0], y[0]) / vec2(camera.right.w, camera.up.w);
    vec2 high = vec2(x[1], y[1]) / vec2(camera.right.w, camera.up.w);
    // One pixel more on each side, so that rounding never cuts a rim pixel; never more than the
    // image.
    vec2 pixel = 2.0 / vec2(camera.width, camera.height);
    low = clamp(low - pixel, vec2(-1.0), vec2(1.0));
    high = clamp(high + pixel, vec2(-1.0), vec2(1.0));
    vec2 corner = mix(low, high, vec2(gl_VertexIndex & 1, gl_VertexIndex >> 1));
    gl_Position = vec4(corner.x, -corner.y, 0.5, 1.0);
}
