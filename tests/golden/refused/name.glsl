vec3 reflected(Surface s) { return s.f0; }
