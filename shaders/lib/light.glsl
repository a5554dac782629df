// Analytic lights.

#include "generated/constants.glsl"
#include "generated/layout.glsl"

// The unit direction from a point to a light, and the light's irradiance on a surface facing it.
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
