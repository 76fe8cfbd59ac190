// Scalar x length in opacity unit distances, added up.
vec4 slice_color(float s, vec3 p, float piece) {
    return vec4(clamp(s, 0.0, 1.0) * piece * u_inverse_unit_distance);
}
