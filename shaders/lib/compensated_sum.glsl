// Sums of many floats with the error of one: the low part dropped by each addition is kept.
// [Knuth97 section 4.2.2]

struct CompensatedSum {
    vec3 high;
    vec3 low;
};

// `sum` plus x. `precise` forbids the compiler the algebra that would make the error term 0.
CompensatedSum compensated_add(CompensatedSum sum, vec3 x) {
    precise vec3 high = sum.high + x;
    precise vec3 x_part = high - sum.high;
    precise vec3 error = (sum.high - (high - x_part)) + (x - x_part);
    precise vec3 low = sum.low + error;
    return CompensatedSum(high, low);
}
