// Hook <march>: the loop over the samples of a ray through several layers, which all are sampled at the same points.
//
// Segments and samples are those of march.glsl; the ray is cut from where it enters the first layer to where it leaves the
// last, and a layer has the part of a segment that lies in its box. Layers of one lattice share its place on the ray:
// LATTICE is the number of the layer that stands for it. What is made of the samples is the hook <composite>, which must
// define
//     COMPOSITE_SKIPS       1 when segments without visible samples may be left out
//     void layers_begin(float ray_length)   world units
//     bool labels_begin()   faces of labels that are cut where the ray begins; true = the ray can end
//     bool layers_add(float segment_length)
//                           true = the ray can end; g_at and g_share of each lattice are those of the segment's sample,
//                           `samples` the scalars there, one for each layer
//     vec4 layers_end()     premultiplied colour of the ray
// Layers of labels are surfaces in the matter of the others: before layers_add is called, label.glsl has looked for a
// border in the segment.
// MODE of a layer is 0: its matter is added, 1: it masks the others, 2: it modulates their extinction. ADDS of a lattice
// is 1 when it has a layer whose matter is added.

#include "rays.glsl"
#include "noise.glsl"

uniform sampler2D t_layer_tables;      // one row for each layer
uniform sampler3D t_layer_distances;   // fields of empty space, one above the other

#pragma each_lattice
#include "lattice.glsl"
#pragma end
#pragma each_layer
#include "layer.glsl"
#pragma end
#pragma each_label
#include "label.glsl"
#pragma end

uniform float u_step;              // world units
uniform float u_first_sample;      // fraction of a step
uniform float u_early_termination; // opacity at which a ray ends
uniform bool u_jitter;
uniform float u_jitter_seed;

#if LAYERS > 0
float samples[LAYERS];
#endif

// What masks leave of the others, and with them layers that modulate.
float seen_through_masks() {
    float left = 1.0;
#pragma each_layer
#if MODE == 1
    left *= step(0.5, layer_color(samples[LAYER], samples[LAYER], AT_LATTICE).a) * SHARE_OF_LATTICE;
#endif
#pragma end
#pragma each_label
#if MODE == 1
    left *= look_of(label_at(AT_LATTICE)).a > 0.0 ? SHARE_OF_LATTICE : 0.0;
#endif
#pragma end
    return left;
}

#include <composite>

void take_samples(float at, float begin, float segment_length) {
#pragma each_lattice
    place_in_lattice(at, begin, segment_length);
#pragma end
#pragma each_layer
    samples[LAYER] = sample_scalar(AT_LATTICE);
#pragma end
#pragma each_label
#if MODE == 0
    find_border(begin, segment_length);
#endif
#pragma end
}

// Labels where a segment begins that does not follow the last one.
void find_labels(float begin) {
#pragma each_label
#if MODE == 0
    g_label = label_on_ray(begin);
#endif
#pragma end
}

// Samples k in [first, last) lie in bricks in which a layer may be visible; advances `first` over those that do not.
void next_run(float fraction, float inverse_step, float total, int count, inout int first, out int last) {
    last = first;
    while (first < count) {
        float begin = float(first) * u_step;
        float at = begin + fraction * min(u_step, total - begin);
        float longest = -1e30;
#pragma each_lattice
        longest = max(longest, stay_in_lattice(at, begin, u_step));
#pragma end
        int steps = int(min(abs(longest) * inverse_step, 1e6));
        if (longest > 0.0) {
            last = min(first + 1 + steps, count);
            break;
        }
        first += max(steps, 1);
    }
}

vec4 march(Ray ray, vec2 pixel) {
    float near = 1e30, far = -1e30;
#pragma each_lattice
    enter_lattice(ray);
#if ADDS
    if (g_hit) { near = min(near, g_near); far = max(far, g_far); }
#endif
#pragma end
    if (!(far > near)) return vec4(0.0);
#pragma each_lattice
    begin_lattice(near);
#pragma end
    float total = far - near;
    layers_begin(total);
    find_labels(0.0);
    if (labels_begin()) return layers_end();
    float inverse_step = 1.0 / u_step;
    // a last segment shorter than a thousandth of a step is rounding, not data
    int count = max(int(ceil(total * inverse_step - 1e-3)), 1);
    // VTK leaves the last segment out when it samples the far ends of steps, unless it is whole
    bool far_ends = u_first_sample == 1.0 && !u_jitter;
    if (far_ends && total < (float(count) - 1e-3) * u_step) --count;
    float fraction = u_jitter ? pixel_noise(pixel, u_jitter_seed) : u_first_sample;
    bool done = false;
    int k = 0, follows = 0;
    while (k < count && !done) {
        int last = count;
#if COMPOSITE_SKIPS
        next_run(fraction, inverse_step, total, count, k, last);
#endif
        if (k != follows) find_labels(float(k) * u_step);
        while (k < last) {
            float begin = float(k) * u_step;
            // the last segment is shorter, and so its sample lies elsewhere
            float segment_length = min(u_step, total - begin);
            take_samples(begin + fraction * segment_length, begin, segment_length);
            ++k;
            if (layers_add(segment_length)) { done = true; break; }
        }
        follows = k;
    }
    return layers_end();
}
