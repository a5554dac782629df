// Owen-scrambled Sobol points in the unit square, by arithmetic alone: no tables to bind and load.
//
// A pair of dimensions is one (0, 2)-sequence [Sobol67]; each pair of each pixel and scramble has
// its own nested uniform scramble [Owen97] by hash [Burley20, sections 3 and 4] with the
// permutation of [Vegdahl21]. Estimators that are *added* (one over pair 0, one over pair 1) need
// no index shuffle between the pairs: only a joint integrand would see the pairing. Estimators
// under test take the points of a table, as they are or scrambled for each pixel in a stream of
// their own.

// A 32-bit finaliser: a bijection whose output bits each depend on every input bit [Wellons18].
uint sobol_hash(uint x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    x ^= x >> 16;
    return x;
}

// A key that differs in every bit between pixels, scrambles, user seeds and streams (specular,
// diffuse).
uint sobol_key(uvec2 pixel, uint scramble, uint seed, uint stream) {
    return sobol_hash(pixel.x + sobol_hash(pixel.y + sobol_hash(scramble + sobol_hash(seed + sobol_hash(stream + 1u)))));
}

// Second Sobol dimension with its bits reversed: row k of Pascal's triangle modulo 2 applied to
// `index`. The first dimension with its bits reversed is `index` itself.
uint sobol_second_reversed(uint index) {
    index ^= index >> 16;
    index ^= (index & 0xff00ff00u) >> 8;
    index ^= (index & 0xf0f0f0f0u) >> 4;
    index ^= (index & 0xccccccccu) >> 2;
    index ^= (index & 0xaaaaaaaau) >> 1;
    return index;
}

// Nested uniform scramble of a bit-reversed value: bit k is flipped by a function of the lower bits
// and the key.
uint sobol_scramble_reversed(uint x, uint key) {
    x ^= x * 0x3d20adeau;
    x += key;
    x *= (key >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

// Point `index` of the pair with that key as 32-bit fixed point in [0, 1). `second_reversed` is
// `sobol_second_reversed(index)`, which all pairs share.
uvec2 sobol_point(uint index, uint second_reversed, uvec2 key) {
    return bitfieldReverse(
        uvec2(sobol_scramble_reversed(index, key.x), sobol_scramble_reversed(second_reversed, key.y)));
}

// The keys of the next pair of dimensions; `key` moves on. A chain, each hash of the last one's
// result: hashes of two consecutive numbers are not independent, and the point they make together
// would not be uniform over scrambles, which biases the estimate.
uvec2 sobol_next_pair_key(inout uint key) {
    uint first = sobol_hash(key + 1u);
    key = sobol_hash(first + 1u);
    return uvec2(first, key);
}

// Streams 0 and 1 are the reference's.
const uint PIXEL_STREAM = 2u;

// A point of the unit square under the nested uniform scrambles of both keys, as fixed point.
// [Owen97; Burley20]
uvec2 owen_scrambled(vec2 xi, uvec2 keys) {
    uvec2 reversed = bitfieldReverse(uvec2(xi * exp2(32.0)));
    return bitfieldReverse(uvec2(sobol_scramble_reversed(reversed.x, keys.x), sobol_scramble_reversed(reversed.y, keys.y)));
}

// Fixed point to the open interval (0, 1): the centre of one of 2^23 strata, the most for which f32
// holds every centre.
vec2 sobol_to_unit(uvec2 fixed_point) {
    return (vec2(fixed_point >> 9) + 0.5) * exp2(-23.0);
}
