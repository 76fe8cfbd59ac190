// The mean scalar along the ray, weighted by length, classified afterwards.
#pragma per_layer
#define COMPOSITE_SKIPS 0
#include "scalar_result.glsl"

float g_sum;
float g_total;

void composite_begin(float ray_length) {
    g_sum = 0.0;
    g_total = 0.0;
}

bool composite_add(float front, float back, vec3 p, float segment_length, bool full_step) {
    float weight = front >= u_density_threshold ? segment_length : 0.0;
    g_sum += front * weight;
    g_total += weight;
    return false;
}

vec4 composite_end() { return g_total > 0.0 ? classified_result(g_sum / g_total) : vec4(0.0); }
