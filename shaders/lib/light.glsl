// Direct lights; src/instrument/scene/light.rs has the equations and their source.

#include "generated/constants.glsl"
#include "generated/layout.glsl"

struct LightSample {
    // Unit vector to the light.
    vec3 l;
    // Irradiance of a surface that faces the light.
    vec3 irradiance;
};

LightSample light_at(LightData light, vec3 position) {
    if (light.place.w == 0.0) {
        return LightSample(light.place.xyz, light.color.rgb);
    }
    vec3 to_light = light.place.xyz - position;
    float distance2 = max(dot(to_light, to_light), LIGHT_DISTANCE2_MIN);
    vec3 l = to_light * inversesqrt(distance2);
    // 1 - cos of the angle from the axis: the difference itself has no digits near it.
    vec3 off_axis = light.axis.xyz + l;
    float cone = clamp((light.outer_versine - 0.5 * dot(off_axis, off_axis)) * light.axis.w, 0.0, 1.0);
    float in_range = distance2 * light.color.w * light.color.w;
    float window = clamp(1.0 - in_range * in_range, 0.0, 1.0);
    return LightSample(l, light.color.rgb * (cone * cone * window / distance2));
}
