// Emission and absorption of several layers, front to back: extinctions add, and what is emitted is the mean of the
// layers' colours weighted by their extinctions.
#define COMPOSITE_SKIPS 1
#include "joint_matter.glsl"

vec4 g_sum;

void layers_begin(float ray_length) { g_sum = vec4(0.0); }

bool layers_add(float segment_length, bool full_step) {
    vec4 matter = joint_matter();
    if (matter.a > 0.0) {
        float a = 1.0 - exp(-matter.a * segment_length);
        g_sum += (1.0 - g_sum.a) * vec4(matter.rgb * (a / matter.a), a);
    }
    return g_sum.a >= u_early_termination;
}

vec4 layers_end() { return g_sum; }
