// One pixel of the comparison: the texel of viewer.frag under it. One read, so that flipping is
// quick in software too.
uniform sampler2D left_image;
uniform sampler2D right_image;
uniform vec2 canvas_size;
// Texel at the canvas' top left corner, and canvas pixels a texel.
uniform vec2 origin;
uniform float scale;
// Canvas column from which the right image is shown.
uniform float split;
uniform bool shows_clipped;
uniform vec3 background;

out vec4 color;

const float STRIPE_PIXELS = 5.0;

void main() {
    vec2 pixel = vec2(gl_FragCoord.x, canvas_size.y - gl_FragCoord.y);
    ivec2 texel = ivec2(floor(pixel / scale + origin));
    if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, textureSize(left_image, 0)))) {
        color = vec4(background, 1.0);
        return;
    }
    vec4 shaded = pixel.x >= split ? texelFetch(right_image, texel, 0) : texelFetch(left_image, texel, 0);
    bool is_striped = shows_clipped && shaded.a == 0.0 && mod(pixel.x + pixel.y, 2.0 * STRIPE_PIXELS) < STRIPE_PIXELS;
    color = vec4(is_striped ? vec3(1.0, 0.0, 0.9) : shaded.rgb, 1.0);
}
