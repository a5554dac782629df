// Shared by the diffuse lobes of the reference, which sample the cosine. To be included below the
// struct `Lobe`.

#include "generated/constants.glsl"
#include "lib/elementary.glsl"

// Gives these lobes other points than the specular lobe, so that their errors are independent.
const uint LOBE_STREAM = 1u;

float lobe_guide(Lobe lobe, vec3 l_local) {
    return max(l_local.z, 0.0) / PI;
}

// Cosine-weighted direction [Malley88]: a uniform point of the disk, lifted to the hemisphere.
vec3 lobe_sample(Lobe lobe, vec2 xi) {
    float r = sqrt(xi.x);
    return vec3(r * sin_cos_turns(xi.y).yx, sqrt(1.0 - xi.x));
}

float lobe_mirror(Lobe lobe) {
    return 0.0;
}
