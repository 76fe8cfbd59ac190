// Scalar x length in opacity unit distances, added up.
#pragma per_layer

vec4 slice_color(float s, vec3 p, float segment_length) {
    return vec4(clamp(s, 0.0, 1.0) * segment_length * u_inverse_unit_distance);
}
