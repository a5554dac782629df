// Lobes of two widths, along a tangent and across it. Local vectors have the tangent along +x.
//
// Slopes stretched by (x, y) have the distribution of width 1 at the half vector (h.x / x, h.y / y,
// h.z) / q, q its length before: D = D_1 / (x y q^4). Their masking has the one width along the
// azimuth of the direction. [Heitz14]

#include "generated/constants.glsl"
#include "generated/specialization/anisotropy.glsl"

// The widths for alpha and the strength s in [0, 1]; src/instrument/brdf/anisotropy.rs has the
// sources. With ANISOTROPY_NONE both are alpha, and the code is the code for one alpha.
vec2 widths_from_strength(float alpha, float s) {
    vec2 width = vec2(alpha);
    if (ANISOTROPY == ANISOTROPY_GLTF) {
        width.x = mix(alpha, 1.0, s * s);
    } else if (ANISOTROPY == ANISOTROPY_KULLA) {
        width *= vec2(1.0 + s, 1.0 - s);
    } else if (ANISOTROPY == ANISOTROPY_DISNEY) {
        width *= vec2(inversesqrt(1.0 - 0.9 * s), sqrt(1.0 - 0.9 * s));
    } else if (ANISOTROPY == ANISOTROPY_OPENPBR) {
        width.x *= sqrt(2.0 / (1.0 + (1.0 - s) * (1.0 - s)));
        width.y = (1.0 - s) * width.x;
    }
    return clamp(width, ALPHA_MIN, 1.0);
}

// The one width of lookups that know no other, and of the table of albedos: the root of the mean
// square.
float mean_width(vec2 width) {
    return ANISOTROPY == ANISOTROPY_NONE ? width.y : sqrt(0.5 * dot(width, width));
}

// The width along the azimuth of a direction.
float width_along(vec3 w_local, vec2 width) {
    if (ANISOTROPY == ANISOTROPY_NONE) {
        return width.y;
    }
    vec2 stretched = width * w_local.xy;
    return sqrt(dot(stretched, stretched) / max(dot(w_local.xy, w_local.xy), 1e-30));
}

// The half vector of width 1 that the stretch maps to h, and q.
vec4 unstretched(vec3 h_local, vec2 width) {
    vec3 slope = vec3(h_local.xy / width, h_local.z);
    float q = length(slope);
    return vec4(slope / q, q);
}

// Defined for each model by lib/microfacet.glsl.
float d_brdf(vec3 h_local, vec2 width);
