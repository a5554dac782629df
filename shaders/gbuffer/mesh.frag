// The g-buffer texels of one mesh, shaded on both sides. Set 0: binding 1 materials, 2 albedo map,
// 3 metallic map (blue), 4 roughness map (green), 5 normal map, 6 map of f0, 7 map of the specular
// weight (red), 8 map of the coat's weight (red), 9 of its roughness (green) (1x1 that changes
// nothing without one; trilinear). Push constants: GbufferParams.
// Front faces are counter-clockwise.
#include "generated/constants.glsl"
#include "gbuffer/surface.glsl"

layout(set = 0, binding = 1, std430) readonly buffer Materials { MaterialData materials[]; };
layout(set = 0, binding = 2) uniform sampler2D albedo_map;
layout(set = 0, binding = 3) uniform sampler2D metallic_map;
layout(set = 0, binding = 4) uniform sampler2D roughness_map;
layout(set = 0, binding = 5) uniform sampler2D normal_map;
layout(set = 0, binding = 6) uniform sampler2D f0_map;
layout(set = 0, binding = 7) uniform sampler2D specular_map;
layout(set = 0, binding = 8) uniform sampler2D coat_map;
layout(set = 0, binding = 9) uniform sampler2D coat_roughness_map;
layout(push_constant) uniform Params { GbufferParams camera; };

layout(location = 0) in vec3 position_world;
layout(location = 1) in vec3 normal_world;
layout(location = 2) in vec2 uv_up;
layout(location = 3) in vec4 tangent_world;

layout(location = 0) out vec4 position_mask;
layout(location = 1) out vec4 normal_alpha;
layout(location = 2) out vec4 albedo_metallic;
layout(location = 3) out vec4 f0_material;

// Looks up a map at the level whose texels are as wide as the longer step to a neighbouring pixel.
// Drivers may round their own levels; the twin cannot.
vec4 looked_up(sampler2D map, vec2 uv, vec2 across, vec2 down) {
    vec2 size = vec2(textureSize(map, 0));
    across *= size;
    down *= size;
    return textureLod(map, uv, 0.5 * log2(max(max(dot(across, across), dot(down, down)), 1.0)));
}

void main() {
    // Texture coordinates count v from the bottom row, images from the top row.
    vec2 uv = vec2(uv_up.x, 1.0 - uv_up.y);
    vec2 across = dFdxFine(uv), down = dFdyFine(uv);
    MaterialData material = materials[camera.material];
    material.albedo_metallic *= vec4(looked_up(albedo_map, uv, across, down).rgb, looked_up(metallic_map, uv, across, down).b);
    float perceptual_roughness = looked_up(roughness_map, uv, across, down).g;
    material.f0_alpha.a = max(material.f0_alpha.a * (perceptual_roughness * perceptual_roughness), ALPHA_MIN);
    material.f0_alpha.rgb = min(material.f0_alpha.rgb * looked_up(f0_map, uv, across, down).rgb, 1.0);
    if (material.coat.x > 0.0) {
        float coat_roughness = looked_up(coat_roughness_map, uv, across, down).g;
        material.coat.xy *= vec2(looked_up(coat_map, uv, across, down).r, coat_roughness * coat_roughness);
    }
    float specular = material.specular.x * looked_up(specular_map, uv, across, down).r;
    // Interpolated vectors are not unit vectors, and maps are baked for them [Mikkelsen08].
    vec3 mapped = looked_up(normal_map, uv, across, down).xyz;
    vec4 tangent = tangent_world;
    bool shows_tangents = material.tangent.w != 0.0;
    if (shows_tangents) {
        tangent = tangent_or_east(tangent, normal_world);
        // Without a map the direction is +x: there the flat map has (0, 0, 1).
        vec2 direction = mapped.xy + vec2(mapped.z, 0.0);
        float strength = length(direction);
        direction = strength > 0.0 ? direction / strength : vec2(1.0, 0.0);
        vec2 turn = material.tangent.xy;
        mapped = vec3(turn.x * direction.x - turn.y * direction.y, turn.y * direction.x + turn.x * direction.y, 0.0);
        material.f0_alpha.a = material.tangent.z * strength;
    }
    // Winding and normals agree (scene::Mesh): a back face is one whose normal points to the far
    // side.
    vec3 w = from_tangent_frame(mapped, tangent, normal_world);
    w = gl_FrontFacing ? w : -w;
    vec3 n = shows_tangents ? normalize(w) : visible_normal(w, direction_to_viewer(camera, position_world));
    GbufferTexels texels = gbuffer_texels(position_world, n, material, camera.material);
    if (specular < 1.0) {
        texels.f0_material.rgb = weighted_f0(material, specular);
    }
    position_mask = texels.position_mask;
    normal_alpha = texels.normal_alpha;
    albedo_metallic = texels.albedo_metallic;
    f0_material = texels.f0_material;
}
