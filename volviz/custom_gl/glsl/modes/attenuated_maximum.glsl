// The largest scalar, each weakened by what lies before it: max of s exp(-attenuation x integral of s so far).
#define MODE_SKIPS 0
#define MODE_SEGMENTS 0
#include "modes/scalar_result.glsl"

uniform float u_attenuation;   // per world unit

float g_extreme;
float g_integral;

void mode_begin(float total) {
    g_extreme = 0.0;
    g_integral = 0.0;
}

bool mode_add(float front, float back, vec3 p, float length_of_segment) {
    g_extreme = max(g_extreme, front * exp(-u_attenuation * g_integral));
    g_integral += front * length_of_segment;
    return false;
}

vec4 mode_end() { return classified_result(g_extreme); }
