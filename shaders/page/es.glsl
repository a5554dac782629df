// Functions of the libraries that GLSL ES 3.00 lacks. Every shader of the page includes it first.

precision highp float;
precision highp int;
precision highp sampler2D;

// Levels of a whole chain, down to one texel: the libraries count levels only of an environment.
int textureQueryLevels(sampler2D chain) {
    ivec2 size = textureSize(chain, 0);
    int level_count = 1;
    for (int side = max(size.x, size.y); side > 1; side >>= 1) {
        ++level_count;
    }
    return level_count;
}
