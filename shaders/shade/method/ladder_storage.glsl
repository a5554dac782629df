// Method `ladder-storage`: that of `ladder-texels`; the map is another.
#include "shade/method/ladder_texels.glsl"
