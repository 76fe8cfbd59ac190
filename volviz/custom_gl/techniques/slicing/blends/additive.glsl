// Colour x extinction x length, added up.
#include "modes/shaded_sample.glsl"

vec4 slice_color(float s, vec3 p, float piece) {
    vec4 c = shaded_sample(s, p);
    float depth = extinction(c.a) * piece;
    return vec4(c.rgb * depth, depth);
}
