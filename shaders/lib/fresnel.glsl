// Fresnel reflectance with f90 = 1; src/instrument/brdf/fresnel.rs has the equations. Of a kind of
// reflectance only the weight of f90 differs, so that F is linear in f0.

#include "generated/constants.glsl"

// The live view has Schlick's.
#ifdef GL_ES
const float FRESNEL_F0 = FRESNEL_SCHLICK;
const float FRESNEL_MEAN = 0.0;
#else
#include "generated/specialization/fresnel_f0.glsl"
#include "generated/specialization/fresnel_mean.glsl"
#endif

// (1 - v_dot_h)^5, the weight of f90 = 1. [Schlick94 eq. 15]
float schlick_weight(float v_dot_h) {
    float x = clamp(1.0 - v_dot_h, 0.0, 1.0);
    float x2 = x * x;
    return x2 * x2 * x;
}

// Fresnel reflectance from f0 with f90 = 1. [Schlick94 eq. 15]
vec3 f_schlick(float v_dot_h, vec3 f0) {
    return f0 + (1.0 - f0) * schlick_weight(v_dot_h);
}

// The unpolarised reflectance of a dielectric in air, from its f0 below 1. [Walter07 eq. 22]
float f_dielectric(float v_dot_h, float f0) {
    float ior = (1.0 + sqrt(f0)) / (1.0 - sqrt(f0));
    // The floor stands for an index of 1 at a grazing angle, 0/0.
    float c = clamp(v_dot_h, 1e-7, 1.0);
    float g = sqrt((ior - 1.0) * (ior + 1.0) + c * c);
    float across = (g - c) / (g + c);
    float along = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);
    return 0.5 * across * across * (1.0 + along * along);
}

// The weight of f90 of the selected reflectance.
float fresnel_weight(float v_dot_h) {
    return FRESNEL_F0 == FRESNEL_SCHLICK ? schlick_weight(v_dot_h)
                                         : (f_dielectric(v_dot_h, FRESNEL_F0) - FRESNEL_F0) / (1.0 - FRESNEL_F0);
}

// The selected reflectance.
vec3 fresnel(float v_dot_h, vec3 f0) {
    return f0 + (1.0 - f0) * fresnel_weight(v_dot_h);
}

// The mean of the selected reflectance over cosines.
vec3 mean_fresnel(vec3 f0) {
    return FRESNEL_F0 == FRESNEL_SCHLICK ? f0 + (1.0 - f0) / 21.0 : f0 + (1.0 - f0) * FRESNEL_MEAN;
}
