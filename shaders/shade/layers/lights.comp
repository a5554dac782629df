// One invocation adds the image under direct lights (second) to the one under the environment
// (first). Bindings: lib/layered_pixel.glsl.

#include "lib/layered_pixel.glsl"

void main() {
    LayeredPixel pixel;
    if (!layered_pixel(pixel)) {
        return;
    }
    whole[pixel.index] = first[pixel.index] + second[pixel.index];
}
