// A lattice in a ray through several: where the ray lies in its texture coordinates, and between which lengths it is in
// its box. Lengths are world units from where the ray enters the first layer.
#pragma per_layer
#include "clipping.glsl"
#include "empty_space.glsl"

uniform mat4 u_ray_to_lattice;   // texture coordinates in which rays are given -> those of this lattice
uniform vec3 u_lattice_low;      // its box
uniform vec3 u_lattice_high;

vec3 g_start;              // where the ray enters the first layer
vec3 g_direction;          // change per world unit
vec3 g_inverse_direction;  // in bricks
float g_near;
float g_far;
bool g_hit;
vec3 g_at;                 // of the sample
float g_share;             // part of the segment that lies in the box

// The lattice's part of a ray, as lengths from the ray's origin.
void enter_lattice(Ray ray) {
#if LATTICES > 1
    ray.direction = mat3(u_ray_to_lattice) * ray.direction;
    ray.origin = (u_ray_to_lattice * vec4(ray.origin, 1.0)).xyz;
#endif
    g_start = ray.origin;
    g_direction = ray.direction;
    g_inverse_direction = inverse_in_bricks(ray.direction);
#if LATTICES > 1
    intersect_slabs(ray, u_lattice_low, u_lattice_high);
#endif
    g_near = ray.near;
    g_far = ray.far;
    g_hit = g_far > g_near;
}

// Count lengths from a place on the ray instead.
void begin_lattice(float t) {
    g_start += t * g_direction;
    g_near -= t;
    g_far -= t;
}

vec3 on_lattice(float t) { return g_start + t * g_direction; }

bool in_lattice(float t) {
#if LATTICES > 1
    return g_hit && t >= g_near && t <= g_far;
#else
    return true;
#endif
}

// Cut a part of the ray to what lies in the box; false where nothing does.
bool cut_to_lattice(inout float from, inout float to) {
#if LATTICES > 1
    from = max(from, g_near);
    to = min(to, g_far);
    return g_hit && to > from;
#else
    return true;
#endif
}

// Take a sample that stands for a segment.
void place_in_lattice(float at, float begin, float segment_length) {
    g_at = on_lattice(at);
#if LATTICES > 1
    float inside = min(begin + segment_length, g_far) - max(begin, g_near);
    g_share = g_hit ? clamp(inside / segment_length, 0.0, 1.0) : 0.0;
#else
    g_share = 1.0;
#endif
}

// How far the ray stays among bricks that may be visible from a sample on, or, negative, among those that are empty.
float stay_in_lattice(float at, float begin, float segment_length) {
#if LATTICES > 1
    if (!g_hit || begin >= g_far) return -1e30;
    if (begin + segment_length <= g_near) return begin + segment_length - g_near;
#endif
    Brick b = brick_at(on_lattice(at));
    float clear = clear_length(b, g_inverse_direction);
    return b.visible ? clear + 1e-30 : -clear;
}
