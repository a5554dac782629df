// The four texels of the g-buffer, laid out as in src/instrument/gbuffer/mod.rs.
#include "generated/layout.glsl"

// The east of spheres, as math::frame::east.
vec3 east(vec3 n) {
    float across = length(n.xz);
    return across > 0.0 ? vec3(n.z, 0.0, -n.x) / across : vec3(1.0, 0.0, 0.0);
}

// A tangent and its handedness: a mesh without tangents has the east of spheres.
vec4 tangent_or_east(vec4 tangent, vec3 n) {
    return tangent.xyz == vec3(0.0) ? vec4(east(normalize(n)), 1.0) : tangent;
}

// A vector of the tangent frame in world axes.
vec3 from_tangent_frame(vec3 w, vec4 tangent, vec3 n) {
    return w.x * tangent.xyz + w.y * (sign(tangent.w) * cross(n, tangent.xyz)) + w.z * n;
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
