// One scalar of each layer, by the hook <scalar> (maximum.glsl and its like), classified; the colours are added.
#define COMPOSITE_SKIPS 0
#pragma each_layer
#if MODE == 0
#include <scalar>
#endif
#pragma end

void layers_begin(float ray_length) {
#pragma each_layer
#if MODE == 0
    composite_begin(ray_length);
#endif
#pragma end
}

bool labels_begin() { return false; }

bool layers_add(float segment_length) {
    if (seen_through_masks() < 0.5) return false;
#pragma each_layer
#if MODE == 0
    if (SHARE_OF_LATTICE > 0.0) {
        composite_add(samples[LAYER], samples[LAYER], AT_LATTICE, segment_length * SHARE_OF_LATTICE, false);
    }
#endif
#pragma end
    return false;
}

vec4 layers_end() {
    vec4 sum = vec4(0.0);
#pragma each_layer
#if MODE == 0
    sum += composite_end();
#endif
#pragma end
    return min(sum, 1.0);
}
