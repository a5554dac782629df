// Diffuse method `sh9-centres`: as `sh9`, from coefficients that are summed at texel centres.

#include "shade/diffuse/sh9.glsl"
