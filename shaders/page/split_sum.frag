// The specular term of one pixel of the live view by the method `split-sum`; 0 where nothing is hit.
#include "page/surface.glsl"
#include "selected/map_layout.glsl"

uniform FILTERED_MAP prefiltered;
uniform sampler2D dfg;

out vec4 specular;

#include "shade/method/split_sum.glsl"

void main() {
    Surface s;
    specular = vec4(0.0);
    if (surface_here(s)) {
        Surface local = surface_in_environment(s, params);
        specular.rgb = params.environment_scale * specular_radiance(local);
    }
}
