// Shared by the files of shade/lobe/. Each defines a struct `Lobe` with a member `frame` (columns
// are the axes of local vectors), and
//     Lobe lobe_at(Surface, ShadeParams)     the lobe of a surface in the environment's frame,
//     vec3 lobe_sample(Lobe, vec2 xi)        a local direction l,
//     LobeValue lobe_eval(Lobe, vec3 l)      the kernel at l and the density of lobe_sample there,
//     float lobe_guide(Lobe, vec3 l)         that density, for a lobe at least as wide as the cells that guide the environment's samples,
//     float lobe_mirror(Lobe)                the share of the radiance of the local +z alone,
//     vec3 lobe_weight(Surface, dfg, flags)  the factor of the estimate that does not depend on l.

// The kernel (BRDF times n_dot_l, 1/sr), and the density (1/sr) with which `lobe_sample` returns l.
struct LobeValue {
    vec3 value_cos;
    float pdf_l;
};
