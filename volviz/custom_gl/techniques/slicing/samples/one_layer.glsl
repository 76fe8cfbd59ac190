// Hook <samples>: the scalar of one of several layers, number DRAWN, where masks leave it.
#include "layer_set.glsl"

#pragma each_layer
#if LAYER == DRAWN
#include <blend>
#endif
#pragma end

vec4 segment_color(vec3 p, vec3 direction, float front, float back, bool begins, bool ends) {
    enter_lattices(Ray(p, direction, -1e30, 1e30));
    take_samples(0.0, -front, front + back);
    if (seen_through_masks() < 0.5) discard;
#pragma each_layer
#if LAYER == DRAWN
    if (!(SHARE_OF_LATTICE > 0.0) || samples[LAYER] < u_density_threshold) discard;
    return slice_color(samples[LAYER], AT_LATTICE, (front + back) * SHARE_OF_LATTICE);
#endif
#pragma end
}
