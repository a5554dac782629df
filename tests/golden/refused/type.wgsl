fn f(n: vec3f) -> vec3f {
    return 1.0;
}
