// The g-buffer of a mesh, shaded on both sides. Front faces as the page draws them have the normal on the viewer's
// side.
#include "page/gbuffer.glsl"

in vec3 position_world;
in vec3 normal_world;

void main() {
    write_surface(position_world, normalize(gl_FrontFacing ? normal_world : -normal_world));
}
