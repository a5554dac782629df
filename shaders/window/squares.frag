// One pixel of a half whose texels are squares. Set 0: window/half.glsl.
#include "window/half.glsl"

layout(location = 0) out vec4 display;

void main() {
    uvec2 place = min(uvec2(texel_position(gl_FragCoord.xy)), last_texel());
    uvec3 sum = texel(place.x, place.y) * params.brightness;
    display = vec4(vec3(sum >> 8) / 255.0, 1.0);
}
