#include "lib/no_such.glsl"
