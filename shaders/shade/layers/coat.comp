// One invocation adds a coat (third) to its base (first), of which second has the specular term
// alone; src/instrument/shade/coat.rs has the equations. Bindings: lib/layered_pixel.glsl.

#include "lib/layered_pixel.glsl"

float reflectance(uint weight, float n_dot_v, vec2 pair) {
    float fresnel = f_schlick(n_dot_v, vec3(COAT_F0)).x;
    float albedo = COAT_F0 * pair.x + pair.y;
    switch (weight) {
        case COAT_WEIGHT_ONE: return 1.0;
        case COAT_WEIGHT_FRESNEL: return fresnel;
        case COAT_WEIGHT_ALBEDO: return albedo;
        default: return fresnel * albedo;
    }
}

// pow() is undefined at 0.
float power(float x, uint exponent) {
    float product = 1.0;
    for (uint i = 0u; i < exponent; ++i) {
        product *= x;
    }
    return product;
}

void main() {
    LayeredPixel pixel;
    if (!layered_pixel(pixel)) {
        return;
    }
    bool needs_pair = params.is_lookup == 1u || params.loss == COAT_WEIGHT_ALBEDO;
    vec2 pair = needs_pair ? layer_albedo_pair(pixel) : vec2(1.0, 0.0);
    float weight = pixel.weight.r;
    float coat = weight * reflectance(params.scale, pixel.n_dot_v, pair);
    if (params.is_lookup == 1u) {
        coat /= pair.x + pair.y;
    }
    float left = 1.0 - weight * reflectance(params.loss, pixel.n_dot_v, pair);
    float specular = power(left, params.specular_power);
    float diffuse = power(left, params.diffuse_power);
    // The diffuse term is what first has beyond second.
    uint i = pixel.index;
    whole[i] = diffuse * first[i] + (specular - diffuse) * second[i] + coat * third[i];
}
