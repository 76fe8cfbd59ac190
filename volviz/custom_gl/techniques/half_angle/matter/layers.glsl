// Hook <matter>: several layers, each of which throws its shadow on all; surfaces of labels do, too.
#include "layer_set.glsl"
#include "composite/joint.glsl"

vec4 g_lit;

void take_matter(Ray ray, float at) {
    enter_lattices(Ray(ray.origin, ray.direction, -1e30, 1e30));
    take_samples(at, ray.near, ray.far - ray.near);
    g_lit = joint_matter();
}

float inverse_depth() { return g_lit.a > 0.0 ? 1.0 / g_lit.a : 0.0; }

vec3 unlit_matter() { return g_unlit * inverse_depth(); }

vec3 lit_matter() { return g_lit.rgb * inverse_depth(); }

float matter_opacity(float segment_length) { return 1.0 - exp(-g_lit.a * segment_length); }

vec3 transmitted(float segment_length) {
    return exp(-u_kappa * (g_lit.a - u_material_tint * g_unlit) * segment_length);
}

#if LABELS > 0
// Slabs compute where they meet each for itself: borders are looked for this share of a slab farther on, since borders
// along voxels often lie just there.
const float FARTHER = 1e-3;

float extinction_of_matter() { return g_lit.a; }

float begin_of_borders(Ray ray) { return begins_in_slab(ray) ? ray.near : ray.near + 2.0 * FARTHER * g_half; }

void take_labels(Ray ray) { find_labels(begin_of_borders(ray)); }

void take_borders(Ray ray) {
    float begin = begin_of_borders(ray);
    find_borders(begin, (ends_in_slab(ray) ? ray.far : ray.far + 2.0 * FARTHER * g_half) - begin);
}

// What surfaces that end before the present slab leave of light: a surface throws its shadow on what lies more than a slab
// behind it, not on itself. 1 - opacity of each.
float light_past_surfaces(Ray ray) {
    float passing = 1.0;
    Ray shown = Ray(ray.origin, ray.direction, -1e30, 1e30);
    intersect_box(shown);
    intersect_planes(shown);
    float begin = max(shown.near, -3.0 * g_half);
    float end = ray.far - 2.0 * g_half;
    find_labels(begin);
#pragma each_label
#if MODE == 0
    if (begins_in_slab(ray)) passing *= 1.0 - look_of(g_label).a;
#endif
#pragma end
    if (end > begin) {
        find_borders(begin, end - begin);
#pragma each_label
#if MODE == 0
        if (g_border < 1e29) passing *= 1.0 - g_surface.a;
#endif
#pragma end
    }
    return passing;
}
#endif
