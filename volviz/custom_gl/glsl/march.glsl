// The loop over the samples of a ray, for every ray caster.
//
// A ray of world length L is cut into segments of one step; the last one is shorter. One sample stands for each
// segment and lies at the fraction u_first_sample of it (midpoint = 0.5). A sample becomes a colour in layer.glsl, by the
// hooks <fetch>, <classify> and <shade>. What is made of the samples is the hook <composite>, which must define
//     COMPOSITE_SKIPS       1 when segments without visible samples may be left out
//     void composite_begin(float ray_length)   world units
//     bool composite_add(float front, float back, vec3 p, float segment_length, bool full_step)
//                           true = the ray can end; front and back = the scalars at the ends of the segment when
//                           CLASSIFY_SEGMENTS, else both the sample; p = the sample, or the segment's middle, in texture
//                           coordinates; segment_length in world units; full_step = it is u_step
//     vec4 composite_end()  premultiplied colour of the ray
// It may read the uniforms below and what layer.glsl declares.

#include "rays.glsl"
#include "layer.glsl"
#include "empty_space.glsl"
#include "noise.glsl"

uniform float u_step;              // world units
uniform float u_first_sample;      // fraction of a step
uniform float u_early_termination; // opacity at which a ray ends
uniform bool u_jitter;
uniform float u_jitter_seed;

#include <composite>

// Samples k in [first, last) lie in bricks that may be visible; advances `first` over those that are not.
#if COMPOSITE_SKIPS
void next_run(vec3 start, vec3 step_vector, vec3 inverse_direction, float inverse_step, int count,
              inout int first, out int last) {
    last = first;
    while (first < count) {
        Brick b = brick_at(start + float(first) * step_vector);
        int samples = int(clear_length(b, inverse_direction) * inverse_step);
        if (b.visible) {
            last = min(first + 1 + samples, count);
            break;
        }
        first += max(samples, 1);
    }
}
#endif

vec4 march(Ray ray, vec2 pixel) {
    float total = ray.far - ray.near;
    composite_begin(total);
    float inverse_step = 1.0 / u_step;
    // a last segment shorter than a thousandth of a step is rounding, not data
    int count = max(int(ceil(total * inverse_step - 1e-3)), 1);
    if (u_first_sample == 1.0 && total >= (float(count) - 1e-3) * u_step) ++count;
    float fraction = u_jitter ? pixel_noise(pixel, u_jitter_seed) : u_first_sample;
    vec3 entry = ray.origin + ray.near * ray.direction;
    vec3 step_vector = u_step * ray.direction;
    vec3 start = entry + fraction * step_vector;
    vec3 inverse_direction = inverse_in_bricks(ray.direction);
    // the last segment is shorter, and so its sample lies elsewhere
    int full_steps = count - 1;
    float last_length = total - float(full_steps) * u_step;
    bool done = false;
    int k = 0;
    while (k < full_steps && !done) {
#if COMPOSITE_SKIPS
        int last;
        next_run(start, step_vector, inverse_direction, inverse_step, full_steps, k, last);
#else
        int last = full_steps;
#endif
#if CLASSIFY_SEGMENTS
        float front = sample_scalar(entry + float(k) * step_vector);
        while (k < last) {
            float back = sample_scalar(entry + float(k + 1) * step_vector);
            done = composite_add(front, back, entry + (float(k) + 0.5) * step_vector, u_step, true);
            front = back;
            ++k;
            if (done) break;
        }
#else
        while (k < last) {
            vec3 p = start + float(k) * step_vector;
            float s = sample_scalar(p);
            ++k;
            if (composite_add(s, s, p, u_step, true)) { done = true; break; }
        }
#endif
    }
    // VTK leaves the last segment out when it samples the far ends of steps
    if (!done && (CLASSIFY_SEGMENTS == 1 || u_first_sample < 1.0 || u_jitter)) {
        vec3 begin = entry + float(full_steps) * step_vector;
#if CLASSIFY_SEGMENTS
        float front = sample_scalar(begin);
        float back = sample_scalar(begin + last_length * ray.direction);
        composite_add(front, back, begin + 0.5 * last_length * ray.direction, last_length, false);
#else
        vec3 p = begin + fraction * last_length * ray.direction;
        float s = sample_scalar(p);
        composite_add(s, s, p, last_length, false);
#endif
    }
    return composite_end();
}
