// The four texels of the g-buffer, laid out as in src/instrument/gbuffer/mod.rs.
#include "generated/constants.glsl"
#include "generated/layout.glsl"
#include "lib/frame.glsl"

// A tangent and its handedness: a mesh without tangents, or with tangents along n, has the east of
// spheres.
vec4 tangent_or_east(vec4 tangent, vec3 n) {
    vec3 across = cross(n, tangent.xyz);
    // Also false for numbers that are not finite.
    bool is_usable = dot(across, across) > TILT_MIN * TILT_MIN * dot(n, n) * dot(tangent.xyz, tangent.xyz);
    return is_usable ? tangent : vec4(east(normalize(n)), 1.0);
}

// The unit vector from a position to the viewer.
vec3 direction_to_viewer(GbufferParams camera, vec3 position_world) {
    return camera.eye.w > 0.0 ? normalize(camera.eye.xyz - position_world) : -camera.forward.xyz;
}

// The unit normal of a visible surface along w, of any length. Normals of meshes may lean away from
// the viewer, at outlines and by normal maps: they are bent towards v until n.v is COSINE_MIN, so
// that every method and the reference shade one surface that exists.
vec3 visible_normal(vec3 w, vec3 v) {
    // Normals of vertices may cancel.
    if (!(dot(w, w) > 0.0)) {
        return v;
    }
    vec3 n = normalize(w);
    float n_dot_v = dot(n, v);
    return n_dot_v < 0.0 ? normalize(n + (COSINE_MIN - n_dot_v) * v) : n;
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

// The reflectance of a base whose f0 in air is f0, under the material's coat.
vec3 f0_under_coat(vec3 f0, MaterialData material) {
    float weight = material.coat.x;
    if (weight == 0.0) {
        return f0;
    }
    vec4 c = material.f0_under_coat;
    return mix(f0, clamp(c.x + f0 * (c.y + f0 * (c.z + f0 * c.w)), 0.0, 1.0), weight);
}

// The alpha of a base under the material's coat (src/instrument/brdf/under_coat.rs).
float alpha_under_coat(MaterialData material) {
    float alpha = material.f0_alpha.a;
    float weight = material.coat.x;
    uint law = uint(material.coat.z);
    if (weight == 0.0 || law == UNDER_COAT_SAME) {
        return alpha;
    }
    if (law == UNDER_COAT_AT_LEAST_COAT) {
        float roughness = sqrt(alpha);
        roughness = mix(roughness, max(roughness, sqrt(material.coat.y)), weight);
        return roughness * roughness;
    }
    float eta = mix(1.0, 1.0 / COAT_IOR, weight);
    return alpha / sqrt(mix(eta * eta, 1.0, alpha * alpha));
}

// Packs a surface; `material` has its maps' values in it.
GbufferTexels gbuffer_texels(vec3 position, vec3 n, MaterialData material, uint material_index) {
    vec3 albedo = material.albedo_metallic.rgb;
    float metallic = material.albedo_metallic.a;
    vec3 f0 = f0_under_coat(mix(material.f0_alpha.rgb, albedo, metallic), material);
    return GbufferTexels(vec4(position, 1.0), vec4(n, alpha_under_coat(material)), vec4(albedo, metallic),
                         vec4(f0, float(material_index)));
}

// The f0 whose Schlick term, times mix(weight, 1, metallic), is Fresnel's of a surface whose
// dielectric interface reflects that share. A weight of 0 leaves a dielectric any f0.
vec3 weighted_f0(MaterialData material, float weight) {
    vec3 albedo = material.albedo_metallic.rgb;
    float metallic = material.albedo_metallic.a;
    float reflecting = mix(weight, 1.0, metallic);
    vec3 f0 = f0_under_coat(mix(weight * material.f0_alpha.rgb, albedo, metallic), material);
    return reflecting > 0.0 ? f0 / reflecting : material.f0_alpha.rgb;
}
