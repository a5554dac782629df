fn f(n: vec3f, v: vec3f, r: f32, f0: vec3f) -> vec3f {
    return nothing;
}
