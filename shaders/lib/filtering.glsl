// Which level of a filtered map a sample reads.

// Level whose texels, by their true solid angle, cover a sample's; not clamped. [Colbert07 section
// 20.4]
float lod_from_solid_angles(float omega_s, float omega_p) {
    return 0.5 * log2(omega_s / omega_p);
}
