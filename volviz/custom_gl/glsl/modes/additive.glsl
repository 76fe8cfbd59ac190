// Emission only: the sum of colour x extinction x length, independent of the step.
#define MODE_SKIPS 1
#define MODE_SEGMENTS 0
#include "modes/shaded_sample.glsl"

vec4 g_sum;

void mode_begin(float total) { g_sum = vec4(0.0); }

bool mode_add(float front, float back, vec3 p, float length_of_segment, bool whole) {
    vec4 c = shaded_sample(front, p);
    float depth = extinction(c.a) * length_of_segment;
    g_sum += vec4(c.rgb * depth, depth);
    return false;
}

vec4 mode_end() { return clamp(g_sum, 0.0, 1.0); }
