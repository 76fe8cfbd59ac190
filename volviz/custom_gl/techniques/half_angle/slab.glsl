// The segment of a ray that a fragment of a slice stands for: the ray within the slice's slab, cut by box and planes; and
// what is in it, by the hook <matter>, which must define
//     void take_matter(Ray ray, float at)   a sample at a length along the ray, which stands for its segment
//     vec3 unlit_matter()                   its colour, straight
//     vec3 lit_matter()                     ... as it is seen in full light
//     float matter_opacity(float length)    of that length of it, world units
//     vec3 transmitted(float length)        what passes it on the way from the light
// and, where there are LABELS,
//     void take_labels(Ray ray), then void take_borders(Ray ray)   labels where it begins, and borders in it
//     float begin_of_borders(Ray ray)       from where lengths of borders count
//     float extinction_of_matter()          per world unit
//     float light_past_surfaces(Ray ray)    share of light that surfaces let pass
// It may read what is declared before it.
#include "rays.glsl"

uniform float u_slab;            // thickness of a slab, world units
uniform vec3 u_half_vector;      // normal of the slices, unit, world, towards the light
uniform vec4 u_light_from;       // the light in texture coordinates, w = 0: infinitely far away
uniform vec3 u_kappa;            // attenuation of red, green and blue
uniform float u_material_tint;

float g_half;     // length of a ray from the middle of its slab to a face

bool begins_in_slab(Ray ray) { return ray.near > -g_half; }
bool ends_in_slab(Ray ray) { return ray.far < g_half; }

#include <matter>

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
    g_half = 0.5 * u_slab * slant(world);
    ray.far = g_half;
    ray.near = -g_half;
    intersect_box(ray);
    intersect_planes(ray);
    return ray;
}
