// One invocation occludes an image (first), of which second has the specular term alone if both
// terms are occluded; src/instrument/shade/occlusion.rs has the equations. The weight is the map's
// value. Bindings: lib/layered_pixel.glsl.

#include "lib/elementary.glsl"
#include "lib/layered_pixel.glsl"

// A cone about an axis, up to a hemisphere.
struct Cone {
    // Half angle.
    float angle;
    // 1 - cos of it.
    float versine;
};

Cone cone_of_versine(float versine) {
    return Cone(atan2_precise(sqrt(versine * (2.0 - versine)), 1.0 - versine), versine);
}

float common_solid_angle(Cone a, Cone b, float apart) {
    bool is_a_small = a.angle <= b.angle;
    Cone small = is_a_small ? a : b;
    Cone large = is_a_small ? b : a;
    float smaller_cone = 2.0 * PI * small.versine;
    if (apart <= large.angle - small.angle) {
        return smaller_cone;
    }
    if (apart >= large.angle + small.angle) {
        return 0.0;
    }
    float x = 1.0 - (apart - (large.angle - small.angle)) / (2.0 * small.angle);
    return smaller_cone * x * x * (3.0 - 2.0 * x);
}

float lagarde(float ao, float n_dot_v, float alpha) {
    return clamp(pow(n_dot_v + ao, exp2(-16.0 * alpha - 1.0)) - 1.0 + ao, 0.0, 1.0);
}

float cone(float ao, float n_dot_v, float alpha) {
    // The lobe's cone has the cosine 10^(-alpha^2), the visible one sqrt(1 - ao).
    Cone lobe = cone_of_versine(one_minus_exp(log(10.0) * alpha * alpha));
    Cone visible = cone_of_versine(ao / (1.0 + sqrt(1.0 - ao)));
    float mirror = cone_of_versine(1.0 - n_dot_v).angle;
    return common_solid_angle(visible, lobe, mirror) / common_solid_angle(cone_of_versine(1.0), lobe, mirror);
}

float specular_factor(float ao, float n_dot_v, float alpha) {
    switch (params.specular_occlusion) {
        case SPECULAR_OCCLUSION_AO: return ao;
        case SPECULAR_OCCLUSION_NONE: return 1.0;
        case SPECULAR_OCCLUSION_LAGARDE: return lagarde(ao, n_dot_v, alpha);
        default: return cone(ao, n_dot_v, alpha);
    }
}

void main() {
    LayeredPixel pixel;
    if (!layered_pixel(pixel)) {
        return;
    }
    float rest = pixel.weight.r;
    float specular = specular_factor(rest, min(pixel.n_dot_v, 1.0), pixel.alpha);
    uint i = pixel.index;
    switch (params.occluded) {
        case OCCLUDED_REST: whole[i] = rest * first[i]; break;
        case OCCLUDED_SPECULAR: whole[i] = specular * first[i]; break;
        // The rest is what first has beyond second.
        default: whole[i] = rest * first[i] + (specular - rest) * second[i];
    }
}
