// The weight of irradiance over pi in Babylon.js and PlayCanvas: 1 - F0 of the dielectric, at every roughness and view
// (LEGACY_SPECULAR_ENERGY_CONSERVATION of pbrBlockReflectivity, on by default, 9.35.0; pictures of PlayCanvas 2.23.3).
#include "lib/surface.glsl"

vec3 specular_radiance(Surface s) {
    return (1.0 - s.metallic) * (1.0 - s.f0) * s.albedo;
}
