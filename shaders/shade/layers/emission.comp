// One invocation adds the emission of a surface, the weight, to its image (first). Bindings:
// lib/layered_pixel.glsl.

#include "lib/layered_pixel.glsl"

void main() {
    LayeredPixel pixel;
    if (!layered_pixel(pixel)) {
        return;
    }
    whole[pixel.index] = first[pixel.index] + vec4(pixel.weight.rgb, 0.0);
}
