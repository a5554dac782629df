// The four texels of the g-buffer, laid out as in src/gbuffer/mod.rs.
#include "generated/layout.glsl"

// The east of spheres, as math::frame::east.
vec3 east(vec3 n) {
    float across = length(n.xz);
    return across > 0.0 ? vec3(n.z, 0.0, -n.x) / across : vec3(1.0, 0.0, 0.0);
}

struct GbufferTexels {
    vec4 position_mask;
    vec4 normal_alpha;
    vec4 albedo_metallic;
    vec4 f0_material;
};

// Packs a surface; `material` has its maps' values in it.
GbufferTexels gbuffer_texels(vec3 position, vec3 n, MaterialData material, uint material_index) {
    vec3 albedo = material.albedo_metallic.rgb;
    float metallic = material.albedo_metallic.a;
    vec3 f0 = mix(material.f0_alpha.rgb, albedo, metallic);
    return GbufferTexels(vec4(position, 1.0), vec4(n, material.f0_alpha.a), vec4(albedo, metallic), vec4(f0, float(material_index)));
}
