// Hook <samples>: one volume.
#include "layer.glsl"
#include <blend>

vec4 segment_color(vec3 p, vec3 direction, float front, float back, bool begins, bool ends) {
    float s = sample_scalar(p);
    if (s < u_density_threshold) discard;
    return slice_color(s, p, front + back);
}
