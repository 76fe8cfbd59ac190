// The surfaces of one of several layers: crossings of its isovalues in a segment of the ray. The place on the ray is that
// of the layer's lattice.
#pragma per_layer
#include "layer.glsl"

uniform vec4 u_isovalues;            // fractions of the data range; unused ones larger than any scalar
uniform vec4 u_surface_colors[4];    // straight RGB and opacity

float g_value;          // at the end of the last segment
float g_crossings[4];   // lengths from the ray's beginning, 1e30 where there is none

// `from` is new where the segment does not follow the last one.
void find_crossings(float begin, float end, bool is_new) {
    for (int i = 0; i < 4; ++i) g_crossings[i] = 1e30;
    float from = begin, to = end;
    if (!CUT_TO_LATTICE(from, to)) return;
    float first = g_value;
    if (is_new || from > begin) first = sample_scalar(ON_LATTICE(from));
    float last = sample_scalar(ON_LATTICE(to));
    g_value = last;
    for (int i = 0; i < SURFACES; ++i) {
        float isovalue = u_isovalues[i];
        bool from_inside = first >= isovalue;
        if (from_inside == (last >= isovalue)) continue;
        float near = from, far = to, a = first, b = last;
        for (int n = 0; n < u_bisections; ++n) {
            float middle = 0.5 * (near + far);
            float s = sample_scalar(ON_LATTICE(middle));
            bool before = (s >= isovalue) == from_inside;
            near = before ? middle : near;
            a = before ? s : a;
            far = before ? far : middle;
            b = before ? b : s;
        }
        g_crossings[i] = near + (far - near) * clamp((isovalue - a) / (b - a), 0.0, 1.0);
    }
}

float nearest_crossing() {
    float nearest = 1e30;
    for (int i = 0; i < SURFACES; ++i) nearest = min(nearest, g_crossings[i]);
    return nearest;
}

// Lit colour and opacity of the surface at a crossing, which counts no longer.
vec4 take_crossing(float t, out vec3 gradient) {
    vec4 look = vec4(0.0);
    for (int i = 0; i < SURFACES; ++i) {
        if (g_crossings[i] == t) { look = u_surface_colors[i]; g_crossings[i] = 1e30; break; }
    }
    vec3 p = ON_LATTICE(t);
    gradient = world_gradient(p);
    return vec4(shade(look.rgb, gradient, p), look.a);
}
