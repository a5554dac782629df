// The surface that a pixel of the live view shows, from its g-buffer.

#include "lib/surface.glsl"

uniform ShadeParams params;
uniform sampler2D gbuffer_position;
uniform sampler2D gbuffer_normal;
uniform sampler2D gbuffer_albedo;
uniform sampler2D gbuffer_f0;

// In world axes. False if nothing is hit.
bool surface_here(out Surface s) {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    return surface_from_gbuffer(texelFetch(gbuffer_position, texel, 0), texelFetch(gbuffer_normal, texel, 0),
                                texelFetch(gbuffer_albedo, texel, 0), texelFetch(gbuffer_f0, texel, 0), params.eye, s);
}
