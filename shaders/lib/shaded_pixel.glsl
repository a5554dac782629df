// Shared by the shading passes: the g-buffer in bindings 0 to 4 of set 0 (position.xyz, mask;
// normal.xyz, alpha; albedo.rgb, metallic; f0.rgb, material index; tangent.xyz, strength of the
// anisotropy), the parameters, and the pixel of an invocation.

#include "lib/image_groups.glsl"
#include "lib/surface.glsl"

layout(push_constant) uniform Push {
    ShadeParams params;
};

layout(set = 0, binding = 0) uniform sampler2D gbuffer_position;
layout(set = 0, binding = 1) uniform sampler2D gbuffer_normal;
layout(set = 0, binding = 2) uniform sampler2D gbuffer_albedo;
layout(set = 0, binding = 3) uniform sampler2D gbuffer_f0;
layout(set = 0, binding = 4) uniform sampler2D gbuffer_tangent;

// The pixel of this invocation. False outside of the image.
bool shaded_pixel(out uvec2 pixel) {
    pixel = gl_GlobalInvocationID.xy + uvec2(0u, params.first_row);
    return pixel.x < params.width && pixel.y < params.height;
}

// The surface of a pixel in world axes. False if nothing is hit; `s` is then not set.
bool surface_of_pixel(uvec2 pixel, out Surface s) {
    ivec2 texel = ivec2(pixel);
    if (!surface_from_gbuffer(texelFetch(gbuffer_position, texel, 0), texelFetch(gbuffer_normal, texel, 0),
                              texelFetch(gbuffer_albedo, texel, 0), texelFetch(gbuffer_f0, texel, 0), params.eye, s)) {
        return false;
    }
    if (ANISOTROPY != ANISOTROPY_NONE) {
        s = surface_with_tangent(s, texelFetch(gbuffer_tangent, texel, 0));
    }
    return true;
}

// The place of a pixel in buffers, row-major.
uint index_of_pixel(uvec2 pixel) {
    return pixel.y * params.width + pixel.x;
}

// The place of a pixel in a binding that begins with the first row of the dispatch.
uint index_in_dispatch(uvec2 pixel) {
    return (pixel.y - params.first_row) * params.width + pixel.x;
}
