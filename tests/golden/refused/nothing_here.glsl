vec3 f(vec3 n, vec3 v, float r, vec3 f0) {
    return nothing;
}
