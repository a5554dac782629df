// The surface that a pixel of the live view shows, from its g-buffer and the table of surfaces.

#include "lib/surface.glsl"

uniform ShadeParams params;
uniform sampler2D gbuffer_position;
uniform sampler2D gbuffer_normal;
uniform sampler2D gbuffer_tangent;
uniform sampler2D gbuffer_f0;
// A row a surface. Columns: albedo and metallic; colour and perceptual roughness of the sheen;
// weight and perceptual roughness of the coat.
uniform sampler2D surfaces;

// A column of this pixel's row.
vec4 surface_values(int column) {
    return texelFetch(surfaces, ivec2(column, int(texelFetch(gbuffer_f0, ivec2(gl_FragCoord.xy), 0).w)), 0);
}

// In world axes. False if nothing is hit.
bool surface_here(out Surface s) {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    if (!surface_from_gbuffer(texelFetch(gbuffer_position, texel, 0), texelFetch(gbuffer_normal, texel, 0),
                              surface_values(0), texelFetch(gbuffer_f0, texel, 0), params.eye, s)) {
        return false;
    }
    if (ANISOTROPY != ANISOTROPY_NONE) {
        s = surface_with_tangent(s, texelFetch(gbuffer_tangent, texel, 0));
    }
    return true;
}
