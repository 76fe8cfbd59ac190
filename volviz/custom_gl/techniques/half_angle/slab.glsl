// The segment of a ray that a fragment of a slice stands for: the ray within the slice's slab, cut by box and planes.
#include "rays.glsl"
#include "layer.glsl"

uniform float u_slab;            // thickness of a slab, world units
uniform vec3 u_half_vector;      // normal of the slices, unit, world, towards the light
uniform vec4 u_light_from;       // the light in texture coordinates, w = 0: infinitely far away
uniform vec3 u_kappa;            // attenuation of red, green and blue
uniform float u_material_tint;

// World length of a ray through one slab, per unit of slab thickness: 1 / cosine.
float slant(vec3 world_ray) {
    return length(world_ray) / max(abs(dot(world_ray, u_half_vector)), 1e-4 * length(world_ray));
}

// The ray from a homogeneous point through p, from one face of the slab to the other.
Ray slab_ray(vec4 from, vec3 p) {
    Ray ray;
    vec3 away = from.w * p - from.xyz;
    vec3 world = world_vector(away);
    ray.origin = p;
    ray.direction = away / length(world);
    ray.far = 0.5 * u_slab * slant(world);
    ray.near = -ray.far;
    intersect_box(ray);
    intersect_planes(ray);
    return ray;
}

// Classified sample, straight RGBA, and its gradient as `classify` gives it.
vec4 slab_sample(vec3 p, out vec3 gradient) {
    float s = sample_scalar(p);
    return classify(s, s, p, gradient);
}

// What passes a segment of matter on the way from the light: (1 - a)^(kappa length / unit). Fully opaque matter stops
// (almost) everything even where kappa is small.
vec3 transmitted(vec4 c, float segment_length) {
    float depth = log(max(1.0 - c.a, 1e-37)) * segment_length * u_inverse_unit_distance;
    return exp(u_kappa * (1.0 - u_material_tint * c.rgb) * depth);
}
