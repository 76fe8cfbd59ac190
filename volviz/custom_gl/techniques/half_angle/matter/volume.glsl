// Hook <matter>: one volume.
#include "layer.glsl"

vec4 g_color;       // straight, opacity per unit distance
vec3 g_gradient;
vec3 g_sample;

void take_matter(Ray ray, float at) {
    g_sample = ray.origin + at * ray.direction;
    float s = sample_scalar(g_sample);
    g_color = classify(s, s, g_sample, g_gradient);
}

vec3 unlit_matter() { return g_color.rgb; }

vec3 lit_matter() { return shade(g_color.rgb, g_gradient, g_sample); }

float matter_opacity(float segment_length) { return corrected_opacity(g_color.a, segment_length); }

// (1 - a)^(kappa length / unit). Fully opaque matter stops (almost) everything even where kappa is small.
vec3 transmitted(float segment_length) {
    float depth = log(max(1.0 - g_color.a, 1e-37)) * segment_length * u_inverse_unit_distance;
    return exp(u_kappa * (1.0 - u_material_tint * g_color.rgb) * depth);
}
