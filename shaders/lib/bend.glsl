// A lobe of two widths as the method split-sum-bent knows it: one alpha and a strength, by the
// parameters of a renderer; src/instrument/shade/bend.rs has the sources. For every other method
// BEND has its default, and both alphas are the alpha of the surface.

#include "generated/constants.glsl"
#include "generated/specialization/bend.glsl"
#include "lib/surface.glsl"

// The parts of BEND (src/base/glsl/specialization.rs).
#define BEND_PARAMETERS (BEND & 15u)
#define BEND_NORMAL ((BEND >> 4u) & 15u)
#define BEND_TOWARD ((BEND >> 8u) & 15u)
#define BEND_DFG_WIDTH (BEND >> 12u)

float bend_alpha(Surface s) {
    if (BEND_PARAMETERS == BEND_PARAMETERS_NARROW) {
        return s.width.y;
    } else if (BEND_PARAMETERS == BEND_PARAMETERS_MEAN) {
        return 0.5 * (s.width.x + s.width.y);
    } else if (BEND_PARAMETERS == BEND_PARAMETERS_GEOMETRIC) {
        return sqrt(s.width.x * s.width.y);
    }
    return s.alpha;
}

float bend_strength(Surface s) {
    vec2 width = s.width;
    if (BEND_PARAMETERS == BEND_PARAMETERS_NARROW) {
        return width.x > width.y ? sqrt((width.x - width.y) / (1.0 - width.y)) : 0.0;
    } else if (BEND_PARAMETERS == BEND_PARAMETERS_MEAN) {
        return (width.x - width.y) / (width.x + width.y);
    } else if (BEND_PARAMETERS == BEND_PARAMETERS_GEOMETRIC) {
        return min((1.0 - width.y / width.x) / 0.9, 1.0);
    }
    return 0.0;
}

// The alpha at which the method reads the DFG table. What the specular term reflects, a
// compensation and the diffuse term must agree on it: else a white furnace gains or loses light.
float table_alpha(Surface s) {
    return BEND_DFG_WIDTH == 0u ? bend_alpha(s) : s.alpha;
}
