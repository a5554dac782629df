// Analytic lights.
#ifndef LIGHT_GLSL
#define LIGHT_GLSL

#include "generated/constants.glsl"
#include "generated/layout.glsl"

// What one light sends to one point: the unit direction to it and its irradiance on a surface that faces it.
struct LightSample {
    vec3 l;
    vec3 irradiance;
};

// The light at a world position. A point light falls off with the squared distance.
LightSample light_at(LightData light, vec3 position) {
    if (uint(light.color_kind.w) == LIGHT_DIRECTIONAL) {
        return LightSample(light.position_or_direction.xyz, light.color_kind.rgb);
    }
    vec3 to_light = light.position_or_direction.xyz - position;
    // A light on the surface itself would divide by zero.
    float distance2 = max(dot(to_light, to_light), 1e-12);
    return LightSample(to_light * inversesqrt(distance2), light.color_kind.rgb / distance2);
}

#endif
