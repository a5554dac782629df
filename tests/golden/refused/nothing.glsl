vec3 specular_radiance(Surface s) {
    return nothing;
}
