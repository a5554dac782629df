// The split sum of a lobe of two widths about a bent normal; src/instrument/shade/bend.rs has the
// sources.

#include "lib/bend.glsl"
#include "lib/split_sum.glsl"

float frostbite_share(float alpha) {
    return (1.0 - alpha) * (sqrt(1.0 - alpha) + alpha);
}

float quartic_share(float strength, float width) {
    float base = 1.0 - strength * (1.0 - width);
    return 1.0 - (base * base) * (base * base);
}

// In local axes.
vec3 bent_normal(vec3 v, vec2 width, float alpha, float strength) {
    vec3 z = vec3(0.0, 0.0, 1.0);
    vec3 g = vec3(v.x, 0.0, v.z);
    float pr = sqrt(alpha);
    if (BEND_NORMAL == BEND_NORMAL_STRENGTH) {
        return normalize(mix(z, g, strength));
    } else if (BEND_NORMAL == BEND_NORMAL_LINEAR) {
        return normalize(mix(z, g, strength * min(5.0 * pr, 1.0)));
    } else if (BEND_NORMAL == BEND_NORMAL_QUARTIC) {
        return normalize(mix(z, g, quartic_share(strength, pr)));
    } else if (BEND_NORMAL == BEND_NORMAL_QUARTIC_UNIT) {
        return normalize(mix(z, normalize(g), quartic_share(strength, pr)));
    } else if (BEND_NORMAL == BEND_NORMAL_QUARTIC_ALPHA) {
        return normalize(mix(z, normalize(g), quartic_share(strength, alpha)));
    } else if (BEND_NORMAL == BEND_NORMAL_QUARTIC_ROOT) {
        return normalize(mix(z, normalize(g), quartic_share(strength, sqrt(pr))));
    } else if (BEND_NORMAL == BEND_NORMAL_ROOT) {
        return normalize(mix(z, g, strength * min(1.5 * sqrt(pr), 1.0)));
    } else if (BEND_NORMAL == BEND_NORMAL_CAP) {
        vec3 v_standard = normalize(vec3(width * v.xy, v.z));
        return normalize(vec3(width * v_standard.xy, 0.5 + 0.5 * v_standard.z));
    }
    return z;
}

vec3 specular_radiance(Surface s) {
    float alpha = bend_alpha(s);
    float strength = bend_strength(s);
    mat3 frame = frame_of_surface(s);
    vec3 v = vec3((s.v * frame).xy, s.n_dot_v);
    vec3 z = vec3(0.0, 0.0, 1.0);
    vec3 normal = bent_normal(v, s.width, alpha, strength);
    vec3 direction = reflect(-v, normal);
    float perceptual_roughness = perceptual_roughness_from_alpha(alpha);
    if (BEND_TOWARD == BEND_TOWARD_NORMAL) {
        direction = mix(direction, z, alpha * alpha);
    } else if (BEND_TOWARD == BEND_TOWARD_BENT) {
        direction = mix(direction, normal, alpha);
    } else if (BEND_TOWARD == BEND_TOWARD_BENT_LESS) {
        direction = mix(direction, normal, alpha * alpha);
    } else if (BEND_TOWARD == BEND_TOWARD_TWICE) {
        direction = mix(normal, normalize(mix(direction, normal, alpha * alpha)), frostbite_share(alpha));
    } else if (BEND_TOWARD == BEND_TOWARD_UNITY) {
        perceptual_roughness *= min(1.2 - strength, 1.0);
        float level = alpha_from_perceptual_roughness(perceptual_roughness);
        float smoothness = 1.0 - level;
        float share = min(smoothness * smoothness + smoothness * s.n_dot_v * s.n_dot_v, 1.0);
        vec3 bent = mix(z, direction, (sqrt(smoothness) + level) * share);
        direction = mix(bent, direction, smoothstep(0.0, 1.0, level * level));
    } else if (BEND_TOWARD == BEND_TOWARD_CAP) {
        vec3 wide = normalize(mix(z, reflect(-v, z), frostbite_share(alpha)));
        direction = mix(direction, wide, clamp((alpha - 0.4) / 0.4, 0.0, 1.0));
    }
    vec2 a_b = albedo_pair(dfg, s.n_dot_v, table_alpha(s));
    return prefiltered_radiance(frame * normalize(direction), perceptual_roughness) * (s.f0 * a_b.x + a_b.y);
}
