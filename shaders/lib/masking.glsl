// The masking-shadowing of a pipeline, one of MASKING_*; in GLSL ES, which has no such constants, a
// uniform.

#ifdef GL_ES
uniform uint MASKING;
#else
layout(constant_id = 0) const uint MASKING = 0;
#endif
