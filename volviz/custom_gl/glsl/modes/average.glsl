// The mean scalar along the ray, weighted by length, classified afterwards.
#define MODE_SKIPS 0
#define MODE_SEGMENTS 0
#include "modes/scalar_result.glsl"

float g_sum;
float g_total;

void mode_begin(float total) {
    g_sum = 0.0;
    g_total = 0.0;
}

bool mode_add(float front, float back, vec3 p, float length_of_segment) {
    g_sum += front * length_of_segment;
    g_total += length_of_segment;
    return false;
}

vec4 mode_end() { return classified_result(g_sum / max(g_total, 1e-20)); }
