// Sample points, and the samples that BRDF samplers make of them.
//
// A sample point is vec4(u, cos phi, sin phi, w): u in [0, 1) drives the polar angle and is 0 at
// the lobe's centre, phi is the azimuth, and w = -ln(1 - u) spares the shader a logarithm (and its
// error) for each sample.

#include "lib/elementary.glsl"

// A half vector and its density, 1/sr of h: pdf_h = D(h) n_dot_h.
struct LobeSample {
    vec3 h_local;
    float pdf_h;
};

// A half vector that a view sees; the density (1/sr) of the mirrored view, and D / (4 n_dot_v) over
// that density.
struct VisibleSample {
    vec3 h_local;
    float pdf_l;
    float d_over_pdf;
};

// The i-th point of this dispatch; each entry point that uses it defines it.
vec4 sample_point(uint i);

// The sample point of (u, cos and sin of phi).
vec4 sample_point_from_polar(float u, vec2 cos_sin_phi) {
    return vec4(u, cos_sin_phi, -log_one_minus(u));
}

// The sample point of xi in the unit square: u = xi.x, phi = 2 pi xi.y.
vec4 sample_point_from_xi(vec2 xi) {
    return sample_point_from_polar(xi.x, sin_cos_turns(xi.y).yx);
}
