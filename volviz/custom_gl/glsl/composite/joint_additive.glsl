// Emission of several layers only: the sum of colour x extinction x length, independent of the step.
#define COMPOSITE_SKIPS 1
#include "joint_matter.glsl"

vec4 g_sum;

void layers_begin(float ray_length) { g_sum = vec4(0.0); }

bool labels_begin() { return false; }

bool layers_add(float segment_length) {
    g_sum += joint_matter() * segment_length;
    return false;
}

vec4 layers_end() { return clamp(g_sum, 0.0, 1.0); }
