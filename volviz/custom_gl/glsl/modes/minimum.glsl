// The smallest scalar along the ray, classified afterwards.
#define MODE_SKIPS 0
#define MODE_SEGMENTS 0
#include "modes/scalar_result.glsl"

float g_extreme;

void mode_begin(float total) { g_extreme = 2.0; }

bool mode_add(float front, float back, vec3 p, float length_of_segment, bool whole) {
    if (front >= u_density_threshold) g_extreme = min(g_extreme, front);
    return false;
}

vec4 mode_end() { return g_extreme > 1.5 ? vec4(0.0) : classified_result(g_extreme); }
