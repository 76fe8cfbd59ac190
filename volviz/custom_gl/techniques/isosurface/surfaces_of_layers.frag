// Isosurfaces and labels of several layers along one ray: the crossings of all layers in a segment, from the nearest on.
#include "rays.glsl"
#include "layer_set.glsl"

uniform int u_bisections;

#pragma each_layer
#if MODE == 0
#include "layer_surfaces.glsl"
#endif
#pragma end

in vec2 v_ndc;
out vec4 f_color;

// Accumulated opacity from which a ray ends, and from which on its depth is known.
const float OPAQUE = 0.999;
const float SEEN = 0.5;

vec4 g_sum = vec4(0.0);
float g_depth = 1.0;
vec3 g_point = vec3(0.0), g_normal = vec3(0.0);   // of the nearest surface

// What layers that mask and modulate leave of a surface at a length along the ray.
float left_of_surface(float t) {
#if MASKED
    take_samples(t, t - 1e-4 * u_step, 2e-4 * u_step);
    float left = seen_through_masks();
#pragma each_layer
#if MODE == 2
    left *= layer_color(samples[LAYER], samples[LAYER], AT_LATTICE).a * SHARE_OF_LATTICE;
#endif
#pragma end
    return left;
#else
    return 1.0;
#endif
}

void blend_surface(vec4 look, vec3 gradient, vec3 p) {
    if (g_depth == 1.0 && g_sum.a + (1.0 - g_sum.a) * look.a >= SEEN) g_depth = window_depth(p);
    if (g_sum.a == 0.0) { g_point = p; g_normal = -gradient; }
    g_sum += (1.0 - g_sum.a) * look.a * vec4(look.rgb, 1.0);
}

void main() {
    Ray ray = make_ray(v_ndc);
    if (!(ray.far > ray.near)) discard;
    float total = enter_layers(ray);
    if (!(total > 0.0)) discard;
    vec3 entry = ray.origin + ray.near * ray.direction;
    float inverse_step = 1.0 / u_step;
    int count = max(int(ceil(total * inverse_step - 1e-3)), 1);
    float turns = 0.0;
    int k = 0, follows = -1;
    find_labels(0.0);
#pragma each_label
#if MODE == 0
    blend_surface(look_of(g_label), vec3(0.0), entry);
#endif
#pragma end
    while (k < count && g_sum.a < OPAQUE) {
        int last;
        next_run(0.0, inverse_step, total, count, k, last);
        bool is_new = k != follows;
        if (is_new) find_labels(float(k) * u_step);
        while (k < last && g_sum.a < OPAQUE) {
            float begin = float(k) * u_step;
            float end = min(begin + u_step, total);
            turns += 1.0;
#pragma each_layer
#if MODE == 0
            find_crossings(begin, end, is_new);
#endif
#pragma end
            find_borders(begin, end - begin);
            is_new = false;
            while (g_sum.a < OPAQUE) {
                float nearest = 1e30;
#pragma each_layer
#if MODE == 0
                nearest = min(nearest, nearest_crossing());
#endif
#pragma end
#pragma each_label
#if MODE == 0
                nearest = min(nearest, begin + g_border);
#endif
#pragma end
                if (nearest > 1e29) break;
                vec4 look;
                vec3 gradient = vec3(0.0);
                bool taken = false;
#pragma each_layer
#if MODE == 0
                if (!taken && nearest_crossing() == nearest) {
                    look = take_crossing(nearest, gradient);
                    taken = true;
                }
#endif
#pragma end
#pragma each_label
#if MODE == 0
                if (!taken && begin + g_border == nearest) {
                    look = g_surface;
                    gradient = g_border_gradient;
                    g_border = 1e30;
                    taken = true;
                }
#endif
#pragma end
                look.a *= left_of_surface(nearest);
                if (look.a > 0.0) blend_surface(look, gradient, entry + nearest * ray.direction);
            }
            ++k;
        }
        follows = k;
    }
    gl_FragDepth = g_depth;
#if DISPLAY_SAMPLES
    f_color = vec4(vec3(turns / 255.0), 1.0);
#else
    if (g_sum.a == 0.0) discard;
#if DISPLAY_POSITIONS
    f_color = vec4(g_point, 1.0);
#elif DISPLAY_NORMALS
    f_color = vec4(0.5 + 0.5 * g_normal / max(length(g_normal), 1e-30), 1.0);
#else
    f_color = g_sum;
#endif
#endif
}
