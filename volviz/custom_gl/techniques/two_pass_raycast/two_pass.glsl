// The ray between a point where it enters the box and one where it leaves.
#include "rays.glsl"

// Positions along the ray count from `entry`; what lies before the near plane, outside the clip planes or behind
// opaque geometry is cut off. entry = exit, or nothing left: far <= near.
Ray ray_between(vec3 entry, vec3 exit, vec2 ndc) {
    Ray ray;
    ray.origin = entry;
    ray.far = world_length(exit - entry);
    ray.direction = (exit - entry) / max(ray.far, 1e-30);
    float near_plane = dot(world_vector(unproject(vec3(ndc, -1.0)) - entry), world_vector(ray.direction));
    ray.near = max(near_plane, 0.0);
    intersect_planes(ray);
#if SCENE_DEPTH
    Ray eye = unclipped_ray(ndc);
    ray.far = min(ray.far, near_plane + scene_distance(eye, ndc));
#endif
    return ray;
}
