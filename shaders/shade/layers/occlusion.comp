// One invocation occludes an image (first), of which second has the specular term alone if both
// terms are occluded; src/instrument/shade/occlusion.rs has the equations. The weight is the map's
// value. Bindings: lib/layered_pixel.glsl.

#include "lib/layered_pixel.glsl"

float common_solid_angle(float a, float b, float apart) {
    float small = min(a, b);
    float large = max(a, b);
    float sine = sin(0.5 * small);
    float smaller_cone = 4.0 * PI * sine * sine;
    if (apart <= large - small) {
        return smaller_cone;
    }
    if (apart >= large + small) {
        return 0.0;
    }
    float x = 1.0 - (apart - (large - small)) / (2.0 * small);
    return smaller_cone * x * x * (3.0 - 2.0 * x);
}

float lagarde(float ao, float n_dot_v, float alpha) {
    return clamp(pow(n_dot_v + ao, exp2(-16.0 * alpha - 1.0)) - 1.0 + ao, 0.0, 1.0);
}

// The angle whose cosine is 1 - versine, for angles up to pi/2, within 2e-8. The built-in function
// may be off by 1e-4, and has no digits near 0. [AbramowitzStegun64 eq. 4.4.46]
float angle_of_versine(float versine) {
    float x = 1.0 - versine;
    float low = 1.5707963050 + x * (-0.2145988016 + x * (0.0889789874 - x * 0.0501743046));
    float high = 0.0308918810 + x * (-0.0170881256 + x * (0.0066700901 - x * 0.0012624911));
    float x2 = x * x;
    return sqrt(versine) * (low + x2 * x2 * high);
}

float cone(float ao, float n_dot_v, float alpha) {
    // 1 - 10^(-alpha^2)
    float x = log(10.0) * alpha * alpha;
    float lobe = angle_of_versine(x < 1e-3 ? x * (1.0 - 0.5 * x) : 1.0 - exp(-x));
    float mirror = angle_of_versine(1.0 - n_dot_v);
    // The visible cone has the cosine sqrt(1 - ao).
    float visible = angle_of_versine(ao / (1.0 + sqrt(1.0 - ao)));
    return common_solid_angle(visible, lobe, mirror) / common_solid_angle(0.5 * PI, lobe, mirror);
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
