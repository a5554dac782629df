// The g-buffer of the live view. As in the renderer, row 0 of every target is the image's top row.

#include "gbuffer/camera.glsl"
#include "gbuffer/surface.glsl"
#include "lib/prefilter_mapping.glsl"

uniform GbufferParams camera;
// All but alpha, which follows from the roughness.
uniform MaterialData material;
uniform float perceptual_roughness;

layout(location = 0) out vec4 position_mask;
layout(location = 1) out vec4 normal_alpha;
layout(location = 2) out vec4 albedo_metallic;
layout(location = 3) out vec4 f0_material;

void write_surface(vec3 position, vec3 n) {
    MaterialData own = material;
    own.f0_alpha.a = alpha_from_perceptual_roughness(perceptual_roughness);
    GbufferTexels texels = gbuffer_texels(position, n, own, 0u);
    position_mask = texels.position_mask;
    normal_alpha = texels.normal_alpha;
    albedo_metallic = texels.albedo_metallic;
    f0_material = texels.f0_material;
}
