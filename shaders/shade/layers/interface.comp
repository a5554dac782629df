// One invocation mixes the images with a dielectric's whole interface (first) and without one
// (second) by the share that it reflects, the weight. Bindings: lib/layered_pixel.glsl.

#include "lib/layered_pixel.glsl"

void main() {
    LayeredPixel pixel;
    if (!layered_pixel(pixel)) {
        return;
    }
    uint i = pixel.index;
    whole[i] = pixel.weight.r * first[i] + (1.0 - pixel.weight.r) * second[i];
}
