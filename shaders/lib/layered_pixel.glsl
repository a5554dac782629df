// Shared by the passes that put up to three images of one geometry together, a pixel an invocation:
// first + second + third times their shares (src/instrument/pipeline/layers.rs). Set 0: 0 to 2 the
// images, a vec4 a pixel, row-major; 3 the result; then texels of g-buffers: 4 position and mask, 5
// normal and alpha, 6 f0 and material of the layer; 7 its weights; 8 rows of its directional albedos
// (A, B) at the nodes of src/instrument/precompute/dfg/albedos.rs.

#include "lib/fresnel.glsl"
#include "lib/image_groups.glsl"

layout(push_constant) uniform Push {
    LayerParams params;
};

layout(std430, set = 0, binding = 0) readonly buffer First { vec4 first[]; };
layout(std430, set = 0, binding = 1) readonly buffer Second { vec4 second[]; };
layout(std430, set = 0, binding = 2) readonly buffer Third { vec4 third[]; };
layout(std430, set = 0, binding = 3) writeonly buffer Whole { vec4 whole[]; };
layout(set = 0, binding = 4) uniform sampler2D layer_position;
layout(set = 0, binding = 5) uniform sampler2D layer_normal;
layout(set = 0, binding = 6) uniform sampler2D layer_f0;
layout(set = 0, binding = 7) uniform sampler2D layer_weights;
layout(std430, set = 0, binding = 8) readonly buffer Albedos { vec2 albedos[]; };

struct LayeredPixel {
    // Its place in the images.
    uint index;
    // Weight or colour of the layer.
    vec4 weight;
    // Of the layer, rounded to a level of perceptual roughness if a material has a map.
    float alpha;
    // At least COSINE_MIN.
    float n_dot_v;
    // Row of its albedos.
    uint row;
};

// The pixel of this invocation. False outside of the image, and where nothing is hit: there the
// first image stays, and it is done.
bool layered_pixel(out LayeredPixel pixel) {
    uvec2 place = gl_GlobalInvocationID.xy;
    if (place.x >= params.width || place.y >= params.height) {
        return false;
    }
    ivec2 texel = ivec2(place);
    pixel.index = place.y * params.width + place.x;
    vec4 position = texelFetch(layer_position, texel, 0);
    if (position.w == 0.0) {
        whole[pixel.index] = first[pixel.index];
        return false;
    }
    vec4 normal = texelFetch(layer_normal, texel, 0);
    vec3 v = params.eye.w == 0.0 ? params.eye.xyz : normalize(params.eye.xyz - position.xyz);
    pixel.weight = texelFetch(layer_weights, texel, 0);
    pixel.n_dot_v = max(dot(normal.xyz, v), COSINE_MIN);
    pixel.alpha = normal.w;
    pixel.row = uint(texelFetch(layer_f0, texel, 0).w);
    if (params.first_level != ALBEDOS_BY_MATERIAL) {
        float level = round(float(LAYER_LEVELS) * sqrt(pixel.alpha));
        pixel.alpha = level * level / float(LAYER_LEVELS * LAYER_LEVELS);
        pixel.row = uint(level) - params.first_level;
    }
    return true;
}

// (A, B) of the layer's lobe, by the cubic through four nodes.
vec2 layer_albedo_pair(LayeredPixel pixel) {
    float last = float(ALBEDO_NODES - 1u);
    float place = clamp((sqrt(pixel.n_dot_v) - ALBEDO_ROOT_MIN) / (1.0 - ALBEDO_ROOT_MIN) * last, 0.0, last);
    float low = clamp(floor(place) - 1.0, 0.0, last - 3.0);
    float t = place - low;
    uint node = pixel.row * ALBEDO_NODES + uint(low);
    return (t - 1.0) * (t - 2.0) * (t - 3.0) / -6.0 * albedos[node]
         + t * (t - 2.0) * (t - 3.0) / 2.0 * albedos[node + 1u]
         + t * (t - 1.0) * (t - 3.0) / -2.0 * albedos[node + 2u]
         + t * (t - 1.0) * (t - 2.0) / 6.0 * albedos[node + 3u];
}
