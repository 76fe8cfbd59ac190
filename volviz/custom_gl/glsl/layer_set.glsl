// Several layers that are sampled at the same points of a ray.
//
// Layers of one lattice share its place on the ray: LATTICE is the number of the layer that stands for it. MODE of a layer
// is 0: its matter is added, 1: it masks the others, 2: it modulates their extinction. ADDS of a lattice is 1 when it has a
// layer whose matter is added. A layer has the part of a segment that lies in its box.
//
// What is made of the samples of a segment is, for those who gather colours along rays, the hook <composite>, which must define
//     COMPOSITE_SKIPS       1 when segments without visible samples may be left out
//     void layers_begin(float ray_length)   world units
//     bool labels_begin()   faces of labels that are cut where the ray begins; true = the ray can end
//     bool layers_add(float segment_length)
//                           true = the ray can end; g_at and g_share of each lattice are those of the segment's sample,
//                           `samples` the scalars there, one for each layer
//     vec4 layers_end()     premultiplied colour of the ray
// Layers of labels are surfaces in the matter of the others: before layers_add is called, label.glsl has looked for a
// border in the segment.

uniform float u_step;                  // world units
uniform isampler2D t_layer_tables;     // curves, one row or more for each layer
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

void enter_lattices(Ray ray) {
#pragma each_lattice
    enter_lattice(ray);
#pragma end
}

// The part of a ray between where it enters the first layer and where it leaves the last: lengths are counted from its
// beginning, the ray's new `near`. Gives its length, 0 where there is none.
float enter_layers(inout Ray ray) {
    enter_lattices(ray);
    float near = 1e30, far = -1e30;
#pragma each_lattice
#if ADDS
    if (g_hit) { near = min(near, g_near); far = max(far, g_far); }
#endif
#pragma end
    if (!(far > near)) return 0.0;
#pragma each_lattice
    begin_lattice(near);
#pragma end
    ray.near = near;
    return far - near;
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

void take_samples(float at, float begin, float segment_length) {
#pragma each_lattice
    place_in_lattice(at, begin, segment_length);
#pragma end
#pragma each_layer
    samples[LAYER] = sample_scalar(AT_LATTICE);
#pragma end
}

// Borders in a segment that begins where the last one ended, or where find_labels has looked.
void find_borders(float begin, float segment_length) {
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
