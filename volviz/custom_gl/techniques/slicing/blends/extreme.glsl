// The scalar itself, blended with MAX or MIN.
#pragma per_layer

vec4 slice_color(float s, vec3 p, float segment_length) { return vec4(s); }
