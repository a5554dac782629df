// Rung `ladder-levels`: as `ladder-view`, but the width is one of the levels of a prefiltered map:
// the linear blend of the two around alpha. Level 0 is the environment at r.

#include "lib/directional_albedo.glsl"
#include "lib/frame.glsl"
#include "lib/lobe.glsl"
#include "generated/specialization/masking.glsl"
#include "lib/prefilter_mapping.glsl"
#include "lib/surface.glsl"

// See lib/microfacet_lobe.glsl.
const uint LOBE_STREAM = 0u;

// Two lobes about r.
struct Lobe {
    mat3 frame;
    // Width of the smoother and of the rougher level.
    vec2 alpha;
    // Share of each; they sum to 1.
    vec2 share;
    // Share of each over the normalisation of its kernel D/4 w(l); 0 for the smoother level if it
    // is the mirror.
    vec2 scale;
};

Lobe lobe_at(Surface s, ShadeParams params) {
    uint level_count = params.prefilter_level_count;
    float lod = lod_from_perceptual_roughness(perceptual_roughness_from_alpha(s.alpha), level_count);
    float low = min(floor(lod), float(level_count) - 2.0);
    vec2 alpha = vec2(alpha_from_perceptual_roughness(perceptual_roughness_from_lod(low, level_count)),
                      alpha_from_perceptual_roughness(perceptual_roughness_from_lod(low + 1.0, level_count)));
    vec2 share = vec2(1.0 - (lod - low), lod - low);
    bool is_mirror = alpha.x < ALPHA_MIN;
    vec2 scale = vec2(is_mirror ? 0.0 : share.x / mirror_weight(alpha.x), share.y / mirror_weight(alpha.y));
    return Lobe(frame_from_normal(normalize(reflect(-s.v, s.n))), alpha, share, scale);
}

// Share of the samples that the rougher lobe takes.
float rougher_share(Lobe lobe) {
    return lobe.scale.x > 0.0 ? lobe.share.y : 1.0;
}

// Density of l under the samplers of both lobes, no narrower than alpha_min.
float lobe_density(Lobe lobe, vec3 h_local, float alpha_min) {
    float rougher = rougher_share(lobe);
    float pdf = rougher * pdf_visible_l_brdf(vec3(0.0, 0.0, 1.0), h_local, vec2(max(lobe.alpha.y, alpha_min)));
    if (rougher < 1.0) {
        pdf += (1.0 - rougher) * pdf_visible_l_brdf(vec3(0.0, 0.0, 1.0), h_local, vec2(max(lobe.alpha.x, alpha_min)));
    }
    return pdf;
}

LobeValue lobe_eval(Lobe lobe, vec3 l_local) {
    vec3 h_local = normalize(l_local + vec3(0.0, 0.0, 1.0));
    float d = lobe.scale.y * d_brdf(h_local, lobe.alpha.y) * prefilter_weight(l_local.z, lobe.alpha.y);
    if (lobe.scale.x > 0.0) {
        d += lobe.scale.x * d_brdf(h_local, lobe.alpha.x) * prefilter_weight(l_local.z, lobe.alpha.x);
    }
    return LobeValue(vec3(0.25 * d), lobe_density(lobe, h_local, 0.0));
}

float lobe_guide(Lobe lobe, vec3 l_local) {
    return l_local.z > 0.0 ? lobe_density(lobe, normalize(l_local + vec3(0.0, 0.0, 1.0)), GUIDE_ALPHA_MIN) : 0.0;
}

vec3 lobe_sample(Lobe lobe, vec2 xi) {
    float rougher = rougher_share(lobe);
    bool is_rougher = xi.x < rougher;
    float u = is_rougher ? xi.x / rougher : (xi.x - rougher) / (1.0 - rougher);
    vec3 v_local = vec3(0.0, 0.0, 1.0);
    return reflect(-v_local, sample_visible_brdf(vec2(u, xi.y), v_local, vec2(is_rougher ? lobe.alpha.y : lobe.alpha.x)));
}

float lobe_mirror(Lobe lobe) {
    return lobe.scale.x > 0.0 ? 0.0 : lobe.share.x;
}

vec3 lobe_weight(Surface s, sampler2D dfg, uint flags) {
    vec4 albedo = directional_albedo(s.n_dot_v, s.alpha, LADDER_NODES, MASKING);
    return s.f0 * albedo.x + albedo.y;
}
