// The g-buffer of a mesh, shaded on both sides. The normal of a front face is on the viewer's side.
#include "page/gbuffer.glsl"

in vec3 position_world;
in vec3 normal_world;
in vec4 tangent_world;

void main() {
    vec3 w = gl_FrontFacing ? normal_world : -normal_world;
    vec3 n = visible_normal(w, direction_to_viewer(camera, position_world));
    write_surface(position_world, n, tangent_world, normal_world);
}
