// Emission and absorption, front to back. With TABLE_PER_STEP the table holds opacities per step, and the unit
// distance is the step: whole segments need no correction.
#define MODE_SKIPS 1
#define MODE_SEGMENTS 0
#include "modes/shaded_sample.glsl"

vec4 g_sum;

void mode_begin(float total) { g_sum = vec4(0.0); }

bool mode_add(float front, float back, vec3 p, float length_of_segment, bool whole) {
    vec4 c = shaded_sample(front, p);
#if TABLE_PER_STEP
    float a = whole ? c.a : corrected_opacity(c.a, length_of_segment);
#else
    float a = corrected_opacity(c.a, length_of_segment);
#endif
    g_sum += (1.0 - g_sum.a) * vec4(c.rgb * a, a);
    return g_sum.a >= u_early_termination;
}

vec4 mode_end() { return g_sum; }
