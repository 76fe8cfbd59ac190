// Colour x extinction x length, added up.
#pragma per_layer

vec4 slice_color(float s, vec3 p, float segment_length) {
    vec4 c = layer_color(s, s, p);
    float depth = extinction(c.a) * segment_length;
    return vec4(c.rgb * depth, depth);
}
