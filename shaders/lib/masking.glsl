// Which masking-shadowing a pipeline uses: one of MASKING_*, set when the pipeline is made. GLSL ES has no such
// constants: there it is a uniform.

#ifdef GL_ES
uniform uint MASKING;
#else
layout(constant_id = 0) const uint MASKING = 0;
#endif
