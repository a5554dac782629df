// One vertex of a model as live.json packs it. Draw: an indexed triangle list.
#include "gbuffer/camera.glsl"

uniform GbufferParams camera;
// The box around the scene.
uniform vec3 low;
uniform vec3 high;

layout(location = 0) in vec3 fraction;
layout(location = 1) in vec2 octahedral;
// Octahedral, and its handedness; zero without a tangent.
layout(location = 2) in vec3 tangent;

out vec3 position_world;
out vec3 normal_world;
out vec4 tangent_world;

// The unit vector of a point of the unfolded octahedron; src/report/live/model.rs has the inverse.
// [Cigolle14]
vec3 unit_from_octahedral(vec2 e) {
    vec3 n = vec3(e, 1.0 - abs(e.x) - abs(e.y));
    float fold = max(-n.z, 0.0);
    n.xy -= vec2(n.x < 0.0 ? -fold : fold, n.y < 0.0 ? -fold : fold);
    return normalize(n);
}

void main() {
    position_world = mix(low, high, fraction);
    normal_world = unit_from_octahedral(octahedral);
    tangent_world = tangent.z == 0.0 ? vec4(0.0) : vec4(unit_from_octahedral(tangent.xy), tangent.z);
    gl_Position = clip_from_camera(camera, camera_from_world(camera, position_world));
}
