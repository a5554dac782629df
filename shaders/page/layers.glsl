// The layers over a base in the live view. What each counts: src/instrument/shade/coat.rs (the
// exact layers) and src/instrument/shade/sheen.rs.

#include "lib/fresnel.glsl"
#include "lib/prefilter_mapping.glsl"
#include "page/surface.glsl"

uniform sampler2D dfg;
// E of a surface's sheen (page/sheen_albedo.frag).
uniform sampler2D sheen_albedo;
// 1 if base and coat add up by the coat's albedo, 0 if by its Fresnel reflectance.
uniform uint coat_layering;
// The layer of a pass.
uniform uint layer;

const uint LAYER_BASE = 0u;
const uint LAYER_SHEEN = 1u;
const uint LAYER_COAT = 2u;

float sheen_albedo_at(float n_dot_v) {
    int last = textureSize(sheen_albedo, 0).x - 1;
    int row = int(texelFetch(gbuffer_f0, ivec2(gl_FragCoord.xy), 0).w);
    float place = sqrt(clamp(n_dot_v, 0.0, 1.0)) * float(last);
    int low = min(int(place), last - 1);
    return mix(texelFetch(sheen_albedo, ivec2(low, row), 0).r, texelFetch(sheen_albedo, ivec2(low + 1, row), 0).r,
               place - float(low));
}

// The share of this pass's layer, whose surface `s` becomes.
vec3 layer_share(inout Surface s) {
    vec4 sheen = surface_values(1);
    vec4 coat = surface_values(2);
    float coat_alpha = max(alpha_from_perceptual_roughness(coat.y), ALPHA_MIN);
    float reflected = f_schlick(s.n_dot_v, vec3(COAT_F0)).x;
    if (coat_layering == 1u) {
        vec2 a_b = albedo_pair(dfg, s.n_dot_v, coat_alpha);
        reflected = COAT_F0 * a_b.x + a_b.y;
    }
    if (layer == LAYER_COAT) {
        s.f0 = vec3(coat_layering == 1u ? COAT_F0 : 1.0);
        s.alpha = coat_alpha;
        s.width = vec2(s.alpha);
        return vec3(coat.x * (coat_layering == 1u ? 1.0 : reflected));
    }
    float left = 1.0 - coat.x * reflected;
    if (layer == LAYER_SHEEN) {
        s.alpha = alpha_from_perceptual_roughness(sheen.a);
        return left * sheen.rgb;
    }
    float lost = max(max(sheen.r, sheen.g), sheen.b) * sheen_albedo_at(s.n_dot_v);
    return vec3(left * max(1.0 - lost, 0.0));
}
