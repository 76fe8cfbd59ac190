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

bool mode_add(float front, float back, vec3 p, float length_of_segment, bool whole) {
    float weight = front >= u_density_threshold ? length_of_segment : 0.0;
    g_sum += front * weight;
    g_total += weight;
    return false;
}

vec4 mode_end() { return g_total > 0.0 ? classified_result(g_sum / g_total) : vec4(0.0); }
