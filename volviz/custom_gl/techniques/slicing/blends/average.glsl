// Scalar x length and length, added up; resolved by division.
vec4 slice_color(float s, vec3 p, float piece) { return vec4(s * piece, 0.0, 0.0, piece); }
