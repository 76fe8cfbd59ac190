// The ray loop, once, for every ray caster.
//
// A ray of world length L is cut into segments of one step; the last one is shorter. One sample stands for each
// segment and lies at the fraction u_first_sample of it (midpoint = 0.5). What is made of the samples is the hook
// <mode>, which must define
//     MODE_SKIPS            1 when segments without visible samples may be left out
//     MODE_SEGMENTS         1 when it wants both ends of a segment (pre-integration) instead of one sample
//     void mode_begin(float L)
//     bool mode_add(float front, float back, vec3 p, float length, bool whole)   true = the ray can end; front =
//                           back = the sample unless MODE_SEGMENTS; p in texture coordinates; length in world
//                           units; whole = the length is u_step
//     vec4 mode_end()       premultiplied colour of the ray

#include "rays.glsl"
#include "sampling.glsl"
#include "classification.glsl"
#include "lighting.glsl"
#include "empty_space.glsl"
#include "noise.glsl"

uniform float u_step;              // world units
uniform float u_first_sample;      // fraction of a step
uniform float u_early_termination; // opacity at which a ray ends
uniform bool u_jitter;
uniform float u_jitter_seed;

#include <mode>

// Samples k in [first, last) lie in bricks that may be visible; advances `first` over those that are not.
#if MODE_SKIPS
void next_run(vec3 start, vec3 along, vec3 inverse_in_bricks, float inverse_step, int count,
              inout int first, out int last) {
    last = first;
    while (first < count) {
        Brick b = brick_at(start + float(first) * along);
        int samples = int(block_exit(b, inverse_in_bricks, b.reach) * inverse_step);
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
    mode_begin(total);
    float inverse_step = 1.0 / u_step;
    // a last piece shorter than a thousandth of a step is rounding, not data
    int count = max(int(ceil(total * inverse_step - 1e-3)), 1);
    if (u_first_sample == 1.0 && total >= (float(count) - 1e-3) * u_step) ++count;
    float fraction = u_jitter ? pixel_noise(pixel, u_jitter_seed) : u_first_sample;
    vec3 entry = ray.origin + ray.near * ray.direction;
    vec3 along = u_step * ray.direction;
    vec3 start = entry + fraction * along;
    vec3 inverse_in_bricks = 1.0 / (ray.direction * u_bricks_per_texture
                                    + vec3(equal(ray.direction, vec3(0.0))) * 1e-20);
    // the last segment is shorter, and so its sample lies elsewhere
    int whole = count - 1;
    float rest = total - float(whole) * u_step;
    bool done = false;
    int k = 0;
    while (k < whole && !done) {
#if MODE_SKIPS
        int last;
        next_run(start, along, inverse_in_bricks, inverse_step, whole, k, last);
#else
        int last = whole;
#endif
#if MODE_SEGMENTS
        float front = sample_scalar(entry + float(k) * along);
        while (k < last) {
            float back = sample_scalar(entry + float(k + 1) * along);
            done = mode_add(front, back, entry + (float(k) + 0.5) * along, u_step, true);
            front = back;
            ++k;
            if (done) break;
        }
#else
        while (k < last) {
            vec3 p = start + float(k) * along;
            float s = sample_scalar(p);
            ++k;
            if (mode_add(s, s, p, u_step, true)) { done = true; break; }
        }
#endif
    }
    // VTK leaves the rest of a ray out when it samples the far ends of steps
    if (!done && (MODE_SEGMENTS == 1 || u_first_sample < 1.0 || u_jitter)) {
        vec3 begin = entry + float(whole) * along;
#if MODE_SEGMENTS
        float front = sample_scalar(begin);
        float back = sample_scalar(begin + rest * ray.direction);
        mode_add(front, back, begin + 0.5 * rest * ray.direction, rest, false);
#else
        vec3 p = begin + fraction * rest * ray.direction;
        float s = sample_scalar(p);
        mode_add(s, s, p, rest, false);
#endif
    }
    return mode_end();
}
