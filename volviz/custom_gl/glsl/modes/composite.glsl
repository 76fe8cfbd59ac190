// Emission and absorption, front to back.
#define MODE_SKIPS 1
#define MODE_SEGMENTS 0
#include "modes/shaded_sample.glsl"

vec4 g_sum;

void mode_begin(float total) { g_sum = vec4(0.0); }

bool mode_add(float front, float back, vec3 p, float length_of_segment) {
    vec4 c = shaded_sample(front, p);
    float a = corrected_opacity(c.a, length_of_segment);
    g_sum += (1.0 - g_sum.a) * vec4(c.rgb * a, a);
    return g_sum.a >= u_early_termination;
}

vec4 mode_end() { return g_sum; }
