// One pixel of the window's controls, in display values times alpha.
// Set 0: 2 texture.

layout(set = 0, binding = 2) uniform sampler2D image;

layout(location = 0) in vec2 uv;
layout(location = 1) in vec4 color;

layout(location = 0) out vec4 display;

void main() {
    display = color * texture(image, uv);
}
