// One corner of a triangle of the window's controls.
// Set 0: 0 vertices, five words each: position in points, texture coordinates, colour (R in the
// lowest byte, times its alpha); 1 indices of vertices; 2 texture, of the fragments. Push
// constants: WindowMeshParams. Draw: 3 a triangle.
#include "generated/layout.glsl"

const uint VERTEX_WORDS = 5u;

layout(push_constant) uniform Push { WindowMeshParams params; };

layout(std430, set = 0, binding = 0) readonly buffer Vertices { uint vertices[]; };
layout(std430, set = 0, binding = 1) readonly buffer Indices { uint indices[]; };

layout(location = 0) out vec2 uv;
layout(location = 1) out vec4 color;

vec2 pair(uint word) {
    return uintBitsToFloat(uvec2(vertices[word], vertices[word + 1u]));
}

void main() {
    uint word = VERTEX_WORDS * indices[gl_VertexIndex];
    uv = pair(word + 2u);
    color = unpackUnorm4x8(vertices[word + 4u]);
    gl_Position = vec4(2.0 * pair(word) / vec2(params.width, params.height) - 1.0, 0.0, 1.0);
}
