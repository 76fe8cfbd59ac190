// Scalar x length and length, added up; resolved by division.
#pragma per_layer

vec4 slice_color(float s, vec3 p, float segment_length) { return vec4(s * segment_length, 0.0, 0.0, segment_length); }
