// Hook <march>: the loop over the samples of a ray through several layers, which all are sampled at the same points.
//
// Segments and samples are those of march.glsl; the ray is cut from where it enters the first layer to where it leaves the
// last. What is made of the samples is the hook <composite>, see layer_set.glsl.

#include "rays.glsl"
#include "noise.glsl"
#include "layer_set.glsl"
#include <composite>

uniform float u_first_sample;      // fraction of a step
uniform bool u_jitter;
uniform float u_jitter_seed;

vec4 march(Ray ray, vec2 pixel) {
    float total = enter_layers(ray);
    if (!(total > 0.0)) return vec4(0.0);
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
            find_borders(begin, segment_length);
            ++k;
            if (layers_add(segment_length)) { done = true; break; }
        }
        follows = k;
    }
    return layers_end();
}
