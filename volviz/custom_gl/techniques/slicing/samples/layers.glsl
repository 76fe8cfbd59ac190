// Hook <samples>: several layers in one integral, and the surfaces of labels in the segment.
#include "layer_set.glsl"
#include <composite>

// Slices compute where two segments meet each for itself: borders are looked for this share of a segment farther on, since
// borders along voxels often lie just there.
const float FARTHER = 1e-3;

vec4 segment_color(vec3 p, vec3 direction, float front, float back, bool begins, bool ends) {
    float segment_length = front + back;
    enter_lattices(Ray(p, direction, -1e30, 1e30));
    take_samples(0.0, -front, segment_length);
    layers_begin(segment_length);
#if LABELS > 0
    float farther = FARTHER * segment_length;
    float first = begins ? -front : farther - front;
    find_labels(first);
    if (begins) labels_begin();
    find_borders(first, (ends ? back : back + farther) - first);
#endif
    layers_add(segment_length);
    return layers_end();
}
