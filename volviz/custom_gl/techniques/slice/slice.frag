// A fragment of a slice: the samples across the slab become one value, which a window or the transfer function colours;
// or each is classified, and they are composited.
#include "clipping.glsl"
#include "sampling.glsl"
#include "classification.glsl"
#if CUBIC
#include "cubic.glsl"
#endif

uniform vec3 u_low;                // what is shown, voxels at the border whole; texture coordinates
uniform vec3 u_high;
uniform int u_samples;             // across the slab
uniform vec3 u_first;              // from the plane to the sample nearest to the eye, texture coordinates
uniform vec3 u_next;               // ... and from one sample to the next
uniform float u_segment;           // length of ray that a sample stands for, world units
uniform vec2 u_grey;               // brightness = fraction * x + y
#if SCENE_DEPTH
uniform sampler2D t_scene_depth;
uniform vec2 u_size;
#endif

in vec3 v_texture;
out vec4 f_color;

float value_at(vec3 p) {
    // outermost voxels reach half a voxel beyond their centres
    p = clamp(p, 0.5 / u_voxels, 1.0 - 0.5 / u_voxels);
#if CUBIC
    return cubic_scalar(p);
#else
    return sample_scalar(p);
#endif
}

void main() {
#if SCENE_DEPTH
    if (gl_FragCoord.z > textureLod(t_scene_depth, gl_FragCoord.xy / u_size, 0.0).r) discard;
#endif
    if (is_clipped(v_texture)) discard;
    vec4 sum = vec4(0.0);
    float total = 0.0, inside = 0.0;
    for (int i = 0; i < u_samples; ++i) {
        vec3 p = v_texture + u_first + float(i) * u_next;
        if (any(lessThan(p, u_low - CLIP_TOLERANCE)) || any(greaterThan(p, u_high + CLIP_TOLERANCE))) continue;
        float s = value_at(p);
#if SLAB_COMPOSITE
        vec4 c = curve_color(s);
        c.a = corrected_opacity(c.a, u_segment);
        sum += (1.0 - sum.a) * c.a * vec4(c.rgb, 1.0);
#elif SLAB_MAXIMUM
        total = inside > 0.0 ? max(total, s) : s;
#elif SLAB_MINIMUM
        total = inside > 0.0 ? min(total, s) : s;
#else
        total += s;
#endif
        inside += 1.0;
    }
    if (inside == 0.0) discard;
#if SLAB_COMPOSITE
    if (sum.a == 0.0) discard;
    f_color = sum;
#else
#if SLAB_MEAN
    total /= inside;
#endif
#if GREY
    f_color = vec4(vec3(clamp(total * u_grey.x + u_grey.y, 0.0, 1.0)), 1.0);
#else
    f_color = vec4(curve_color(total).rgb, 1.0);
#endif
#endif
}
