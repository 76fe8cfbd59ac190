// Premultiplied colour, blended back to front with ONE, ONE_MINUS_SRC_ALPHA.
#include "modes/shaded_sample.glsl"

vec4 slice_color(float s, vec3 p, float piece) {
    vec4 c = shaded_sample(s, p);
    float a = corrected_opacity(c.a, piece);
    return vec4(c.rgb * a, a);
}
