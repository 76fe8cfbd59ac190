// The largest scalar, each weakened by what lies before it: max of s exp(-attenuation x integral of s so far).
#pragma per_layer
#define COMPOSITE_SKIPS 0
#include "scalar_result.glsl"

uniform float u_attenuation;   // per opacity unit distance

float g_extreme;   // negative: no sample counted yet
float g_integral;

void composite_begin(float ray_length) {
    g_extreme = -1.0;
    g_integral = 0.0;
}

bool composite_add(float front, float back, vec3 p, float segment_length, bool full_step) {
    if (front < u_density_threshold) return false;
    float s = clamp(front, 0.0, 1.0);
    g_extreme = max(g_extreme, s * exp(-u_attenuation * g_integral));
    g_integral += s * segment_length * u_inverse_unit_distance;
    return false;
}

vec4 composite_end() { return g_extreme < 0.0 ? vec4(0.0) : classified_result(g_extreme); }
