// Emission and absorption of several layers, front to back: extinctions add, and what is emitted is the mean of the
// layers' colours weighted by their extinctions. The matter of a segment is divided by the surfaces of labels in it.
#define COMPOSITE_SKIPS 1
#include "joint_matter.glsl"

uniform float u_early_termination; // opacity at which a ray ends

vec4 g_sum;

void layers_begin(float ray_length) { g_sum = vec4(0.0); }

void blend(vec3 color, float a) { g_sum += (1.0 - g_sum.a) * vec4(color * a, a); }

void blend_matter(vec4 matter, float piece) {
    if (matter.a > 0.0) blend(matter.rgb / matter.a, 1.0 - exp(-matter.a * piece));
}

bool labels_begin() {
#pragma each_label
#if MODE == 0
    blend(look_of(g_label).rgb, look_of(g_label).a);
#endif
#pragma end
    return g_sum.a >= u_early_termination;
}

// The matter of a segment, and the surfaces in it.
void blend_segment(vec4 matter, float segment_length) {
    float passed = 0.0;
#if LABELS > 0
    for (int n = 0; n < LABELS; ++n) {
        float nearest = 1e30;
        vec4 surface;
#pragma each_label
#if MODE == 0
        if (g_border < nearest) { nearest = g_border; surface = g_surface; }
#endif
#pragma end
        if (nearest > 1e29) break;
        bool taken = false;
#pragma each_label
#if MODE == 0
        if (!taken && g_border == nearest) { g_border = 1e30; taken = true; }
#endif
#pragma end
        blend_matter(matter, nearest - passed);
        blend(surface.rgb, surface.a);
        passed = nearest;
    }
#endif
    blend_matter(matter, max(segment_length - passed, 0.0));
}

bool layers_add(float segment_length) {
    blend_segment(joint_matter(), segment_length);
    return g_sum.a >= u_early_termination;
}

vec4 layers_end() { return g_sum; }
