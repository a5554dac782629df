// Fresnel reflectance by Schlick's approximation, with f90 = 1.

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
