// Diffuse method `ladder-clamp`: as `sh9`, with other coefficients.

#include "shade/diffuse/sh9.glsl"
