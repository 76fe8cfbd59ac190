// The largest scalar along the ray, classified afterwards.
#pragma per_layer
#define COMPOSITE_SKIPS 0
#include "scalar_result.glsl"

const float NO_SAMPLE = 3e38;

float g_extreme;

void composite_begin(float ray_length) { g_extreme = -NO_SAMPLE; }

bool composite_add(float front, float back, vec3 p, float segment_length, bool full_step) {
    if (front >= u_density_threshold) g_extreme = max(g_extreme, front);
    return false;
}

vec4 composite_end() { return g_extreme == -NO_SAMPLE ? vec4(0.0) : classified_result(g_extreme); }
