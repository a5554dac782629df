// Walter's rational fit of the Smith masking of a Beckmann surface; Phong shares it through alpha.

// G1 of a direction with cosine n_dot_w, for a = 1 / (alpha tan theta); 1 from a = 1.6 on.
// [Walter07 eq. 27]
float g1_smith_rational(float n_dot_w, float alpha) {
    if (n_dot_w <= 0.0) {
        return 0.0;
    }
    // a = c / s; numerator and denominator are multiplied by s squared, so that neither end divides
    // by 0.
    float c = n_dot_w;
    float s = alpha * sqrt(max(1.0 - c * c, 0.0));
    float g1 = c * (3.535 * s + 2.181 * c) / (s * s + c * (2.276 * s + 2.577 * c));
    return c >= 1.6 * s ? 1.0 : g1;
}
