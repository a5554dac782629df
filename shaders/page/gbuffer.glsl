// The g-buffer of the live view. As in the renderer, row 0 of every target is the image's top row.
// WebGL2 guarantees four targets: tangents take the place of the albedo, which page/surface.glsl
// reads by the surface's index.

#include "gbuffer/camera.glsl"
#include "gbuffer/surface.glsl"
#include "lib/prefilter_mapping.glsl"

uniform GbufferParams camera;
// All but alpha, which follows from the roughness.
uniform MaterialData material;
uniform float perceptual_roughness;
uniform uint surface_index;

layout(location = 0) out vec4 position_mask;
layout(location = 1) out vec4 normal_alpha;
layout(location = 2) out vec4 tangent_strength;
layout(location = 3) out vec4 f0_material;

// `n_front` is the normal of the front, `tangent` the tangent of a mesh; zero for the east.
void write_surface(vec3 position, vec3 n, vec4 tangent, vec3 n_front) {
    MaterialData own = material;
    own.f0_alpha.a = alpha_from_perceptual_roughness(perceptual_roughness);
    GbufferTexels texels = gbuffer_texels(position, n, own, surface_index);
    position_mask = texels.position_mask;
    normal_alpha = texels.normal_alpha;
    f0_material = texels.f0_material;
    vec3 turned = from_tangent_frame(vec3(own.tangent.xy, 0.0), tangent_or_east(tangent, n_front), n_front);
    tangent_strength = vec4(normalize(turned), own.tangent.z);
}
