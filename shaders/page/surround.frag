// Shared by both methods of the live view: the diffuse term (`sh9`, or none), and the environment
// if nothing is hit.
#include "lib/camera.glsl"
#include "lib/diffuse.glsl"
#include "selected/map_layout.glsl"
#include "page/layers.glsl"
#include "shade/diffuse/sh9.glsl"

uniform BackgroundParams background;
uniform bool has_diffuse;
uniform FILTERED_MAP filtered_environment;
uniform vec4 coefficients[SH9_COUNT];

out vec4 radiance;

void main() {
    Surface s;
    radiance = vec4(0.0);
    if (!surface_here(s)) {
        vec3 d = ray_direction(uvec2(gl_FragCoord.xy), uvec2(background.width, background.height), background.right.xyz,
                               background.up.xyz, background.forward.xyz);
        radiance.rgb = background.environment_scale * map_radiance(filtered_environment, map_place(d), 0.0);
    } else if (has_diffuse) {
        // The method reads neither map nor texture.
        vec3 irradiance = irradiance_over_pi(environment_from_world(s.n, params), filtered_environment, coefficients, dfg);
        vec3 diffuse = params.environment_scale * diffuse_albedo(s, dfg, params.flags) * irradiance;
        radiance.rgb = layer_share(s) * diffuse;
    }
}
