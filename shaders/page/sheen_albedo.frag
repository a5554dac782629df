// E of the sheen of each surface, for page/layers.glsl: a row a surface; column x is at √(n·v) = x
// over the last.
#include "page/sheen_integral.glsl"
#include "lib/prefilter_mapping.glsl"
#include "page/surface.glsl"

uniform uint column_count;

out vec4 albedo;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    float root = float(texel.x) / float(column_count - 1u);
    Surface s;
    s.n_dot_v = max(root * root, COSINE_MIN);
    s.n = vec3(0.0, 0.0, 1.0);
    s.v = vec3(sqrt(1.0 - s.n_dot_v * s.n_dot_v), 0.0, s.n_dot_v);
    s.alpha = alpha_from_perceptual_roughness(texelFetch(surfaces, ivec2(1, texel.y), 0).a);
    Lobe lobe = lobe_at(s, params);
    int count = textureSize(points, 0).x;
    float sum = 0.0;
    for (int i = 0; i < count; ++i) {
        LobeValue kernel = lobe_eval(lobe, sheen_direction(lobe, uint(i)));
        sum += kernel.value_cos.x / (float(count) * kernel.pdf_l);
    }
    albedo = vec4(sum);
}
