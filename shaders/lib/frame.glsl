// Orthonormal frames. Local coordinates have the normal along +z.

// Columns tangent, bitangent, n: `frame * local` is world. No branch, no singular direction.
// [Duff17 listing 3]
mat3 frame_from_normal(vec3 n) {
    float s = n.z >= 0.0 ? 1.0 : -1.0;
    float a = -1.0 / (s + n.z);
    float b = n.x * n.y * a;
    return mat3(vec3(1.0 + s * n.x * n.x * a, s * b, -s * n.x), vec3(b, s + n.y * n.y * a, -n.y), n);
}

// The east of a sphere, as math::frame::east; +x at the poles.
vec3 east(vec3 n) {
    float across = length(n.xz);
    return across > 0.0 ? vec3(n.z, 0.0, -n.x) / across : vec3(1.0, 0.0, 0.0);
}
