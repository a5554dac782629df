// Which masking-shadowing a pipeline uses: one of MASKING_*, set when the pipeline is made.
#ifndef MASKING_GLSL
#define MASKING_GLSL

layout(constant_id = 0) const uint MASKING = 0;

#endif
