// One vertex of a mesh. Push constants: GbufferParams. Draw: an indexed triangle list.
#include "gbuffer/camera.glsl"

layout(push_constant) uniform Params { GbufferParams camera; };

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
layout(location = 3) in vec4 tangent;

layout(location = 0) out vec3 position_world;
layout(location = 1) out vec3 normal_world;
layout(location = 2) out vec2 uv_up;
layout(location = 3) out vec4 tangent_world;

void main() {
    position_world = position;
    normal_world = normal;
    uv_up = uv;
    tangent_world = tangent;
    vec4 clip = clip_from_camera(camera, camera_from_world(camera, position));
    gl_Position = limited_vertex(clip, vec2(camera.width, camera.height));
}
