fn f(n: vec3f) -> vec3f { return n; }
