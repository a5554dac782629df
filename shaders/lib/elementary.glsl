// Elementary functions in f32. Built-in ones are too coarse: some drivers have errors of 1e-4 in
// acos and sin, and exp and log lose all relative precision next to 1. Polynomials: minimax fits by
// this project; errors are given.

#include "generated/constants.glsl"

// asin(x) for 0 <= x <= sqrt(1/2); absolute error below 2e-7.
float asin_half_octant(float x) {
    float t = x * x;
    float p = 0.118193095;
    p = p * t - 0.0829732619;
    p = p * t + 0.0783106889;
    p = p * t + 0.0336318103;
    p = p * t + 0.0762626371;
    p = p * t + 0.166603728;
    return x * (p * t + 1.0000009);
}

// atan(x) for 0 <= x <= 1; absolute error below 2e-7.
float atan_octant(float x) {
    float t = x * x;
    float p = -0.00405455905;
    p = p * t + 0.02186293;
    p = p * t - 0.0559122893;
    p = p * t + 0.0964219482;
    p = p * t - 0.139086287;
    p = p * t + 0.199465655;
    p = p * t - 0.333298608;
    return x * (p * t + 0.999999336);
}

// The angle of (x, y) from +x in (-pi, pi], as atan(y, x); 0 at the origin. Absolute error below
// 3e-7.
float atan2_precise(float y, float x) {
    float ax = abs(x);
    float ay = abs(y);
    // The floor only matters at the origin: 0/0 would be NaN.
    float angle = atan_octant(min(ax, ay) / max(max(ax, ay), 1e-30));
    angle = ay > ax ? 0.5 * PI - angle : angle;
    angle = x < 0.0 ? PI - angle : angle;
    return y < 0.0 ? -angle : angle;
}

// (sin, cos) of 2 pi turns; absolute error below 1.5e-7 for |turns| <= 2, exact at quarter turns.
vec2 sin_cos_turns(float turns) {
    float quarter = round(4.0 * turns);
    float x = turns - 0.25 * quarter;
    float t = x * x;
    float s = x * (((-75.2400626 * t + 81.5881246) * t - 41.341628) * t + 6.28318522);
    float c = ((59.220432 * t - 85.442853) * t + 64.9393162) * t - 19.7392087;
    c = c * t + 1.0;
    int quadrant = int(quarter) & 3;
    vec2 sin_cos = (quadrant & 1) == 0 ? vec2(s, c) : vec2(c, -s);
    return quadrant >= 2 ? -sin_cos : sin_cos;
}

// ln(1 - x) for 0 <= x < 1; relative error below 1e-6. Needed since alpha = 1e-3 puts all of a lobe
// at x < 1e-5.
float log_one_minus(float x) {
    int exponent = 0;
    float m_minus_1 = -x;
    if (x > 0.25) {
        // Mantissa in [1, 2) and exponent from the bits (GLSL ES has no frexp); 1 - x >= 2^-24 is
        // never subnormal.
        uint bits = floatBitsToUint(1.0 - x);
        exponent = int(bits >> 23) - 127;
        float m = uintBitsToFloat((bits & 0x007fffffu) | 0x3f800000u);
        if (m > 1.41421356) {
            m *= 0.5;
            exponent += 1;
        }
        m_minus_1 = m - 1.0;
    }
    // ln m = 2 atanh((m - 1) / (m + 1)); |q| < 0.172, so the first dropped term is below 1e-9.
    float q = m_minus_1 / (m_minus_1 + 2.0);
    float t = q * q;
    float series = ((((1.0 / 9.0) * t + 1.0 / 7.0) * t + 1.0 / 5.0) * t + 1.0 / 3.0) * t + 1.0;
    return 2.0 * q * series + float(exponent) * 0.693147181;
}

// 1 - exp(-x) for x >= 0; relative error below 1e-6, also as x goes to 0.
float one_minus_exp(float x) {
    // Taylor's series. Compilers keep divisions by constants, so there are none.
    float series = 1.0 / 120.0 - x * (1.0 / 720.0);
    series = 1.0 / 24.0 - x * series;
    series = 1.0 / 6.0 - x * series;
    series = 0.5 - x * series;
    series = x * (1.0 - x * series);
    return x < 0.25 ? series : 1.0 - exp(-x);
}
