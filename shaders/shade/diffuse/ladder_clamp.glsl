// Diffuse method `ladder-clamp`: that of `sh9`; the coefficients are others.
#ifndef DIFFUSE_LADDER_CLAMP_GLSL
#define DIFFUSE_LADDER_CLAMP_GLSL

#include "shade/diffuse/sh9.glsl"

#endif
