// The piece of a ray that a fragment of a slice stands for: the ray within the slice's slab, cut by box and planes.
#include "rays.glsl"
#include "sampling.glsl"
#include "classification.glsl"
#include "lighting.glsl"

uniform float u_slab;            // thickness of a slab, world units
uniform vec3 u_half_vector;      // normal of the slices, unit, world, towards the light
uniform vec4 u_light_from;       // the light in texture coordinates, w = 0: infinitely far away
uniform vec3 u_kappa;            // attenuation of red, green and blue
uniform float u_material_tint;

vec3 world_vector(vec3 v) {
    return vec3(dot(u_world_metric_x, v), dot(u_world_metric_y, v), dot(u_world_metric_z, v));
}

// World length of a ray through one slab, per unit of slab thickness: 1 / cosine.
float slant(vec3 world_ray) {
    return length(world_ray) / max(abs(dot(world_ray, u_half_vector)), 1e-4 * length(world_ray));
}

// The ray from a homogeneous point through p, from one face of the slab to the other.
Ray slab_ray(vec4 from, vec3 p) {
    Ray ray;
    vec3 along = from.w * p - from.xyz;
    vec3 world = world_vector(along);
    ray.origin = p;
    ray.direction = along / length(world);
    ray.far = 0.5 * u_slab * slant(world);
    ray.near = -ray.far;
    intersect_box(ray);
    intersect_planes(ray);
    return ray;
}

// Classified sample with its gradient where a variant needs it.
vec4 slab_sample(vec3 p, out vec3 gradient) {
    float s = sample_scalar(p);
    gradient = vec3(0.0);
#if BY_GRADIENT
    if (!may_be_visible(s)) return vec4(0.0);
#endif
#if SHADING || GRADIENT_OPACITY || BY_GRADIENT
    gradient = world_gradient(p);
#endif
#if BY_GRADIENT
    vec4 c = classify(s, length(gradient));
#else
    vec4 c = classify(s);
#endif
#if GRADIENT_OPACITY
    c.a *= gradient_factor(gradient);
#endif
    return c;
}

// What passes a piece of matter on the way from the light: (1 - a)^(kappa length / unit). Fully opaque matter stops
// (almost) everything even where kappa is small.
vec3 transmitted(vec4 c, float world_length_of_piece) {
    float depth = log(max(1.0 - c.a, 1e-37)) * world_length_of_piece * u_inverse_unit_distance;
    return exp(u_kappa * (1.0 - u_material_tint * c.rgb) * depth);
}
