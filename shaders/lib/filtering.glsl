// Which level of a filtered map a sample reads.

// Level at which a texel covers the solid angle of a sample; not clamped. [Colbert07 section 20.4, with the texel's
// true solid angle]
float lod_from_solid_angles(float omega_s, float omega_p) {
    return 0.5 * log2(omega_s / omega_p);
}
