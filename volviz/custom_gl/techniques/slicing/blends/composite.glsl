// Premultiplied colour, blended back to front with ONE, ONE_MINUS_SRC_ALPHA.
#pragma per_layer

vec4 slice_color(float s, vec3 p, float segment_length) {
    vec4 c = layer_color(s, s, p);
    float a = corrected_opacity(c.a, segment_length);
    return vec4(c.rgb * a, a);
}
