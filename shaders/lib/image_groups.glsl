// The work groups of passes over an image. Dispatch: ceil(width / GROUP_SIDE) x ceil(rows /
// GROUP_SIDE) x faces groups, from row first_row on if the pass has one.
#include "generated/constants.glsl"
#include "generated/layout.glsl"

layout(local_size_x = GROUP_SIDE, local_size_y = GROUP_SIDE) in;
