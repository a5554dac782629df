// Ray and sphere, and the sphere's bounds in the image.

// Nearer intersection of the ray `direction` (any length) from 0 with a sphere, relative to
// `center`. False on a miss.
//
// With x = d x c the discriminant is r^2 |d|^2 - |x|^2 and the hit is (d x x - sqrt(discriminant)
// d) / |d|^2. The usual form subtracts two numbers of the size of |c|^2; here nothing larger than
// r^2 cancels, so the rim and the normal keep f32 precision at any distance.
bool intersect_sphere(vec3 direction, vec3 center, float radius, out vec3 hit_from_center) {
    float length_squared = dot(direction, direction);
    vec3 x = cross(direction, center);
    float discriminant = radius * radius * length_squared - dot(x, x);
    hit_from_center = (cross(direction, x) - sqrt(max(discriminant, 0.0)) * direction) / length_squared;
    return discriminant >= 0.0 && dot(direction, center + hit_from_center) > 0.0;
}

// Smallest and largest x / z of a circle of radius r about (x, z), the slopes of its tangents
// through the origin. A circle that reaches the plane z = 0 has no such bounds: the whole image
// (-huge, huge) is returned.
vec2 tangent_slopes(float x, float z, float r) {
    float denominator = z * z - r * r;
    if (z <= r || denominator <= 0.0) {
        return vec2(-1e9, 1e9);
    }
    float half_width = r * sqrt(x * x + denominator);
    return (vec2(x * z) + vec2(-half_width, half_width)) / denominator;
}
