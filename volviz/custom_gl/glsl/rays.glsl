// The ray of a fragment, and the part of it that is to be shown.
//
// Rays are marched in *texture coordinates* of the volume (0..1, voxel centres at (i + 0.5) / N); the parameter t along
// a ray is a length in *world units*, whatever the spacing, direction or shear of the lattice.
#include "clipping.glsl"

uniform mat4 u_clip_to_texture;    // clip space -> texture coordinates
uniform mat4 u_texture_to_clip;    // its inverse
uniform vec3 u_world_metric_x;     // rows of the matrix that takes texture-coordinate vectors to world vectors
uniform vec3 u_world_metric_y;
uniform vec3 u_world_metric_z;
#if SCENE_DEPTH
uniform sampler2D t_scene_depth;   // window depth of opaque geometry
#endif

// A vector in texture coordinates as one in the world.
vec3 world_vector(vec3 v) {
    return vec3(dot(u_world_metric_x, v), dot(u_world_metric_y, v), dot(u_world_metric_z, v));
}

float world_length(vec3 texture_vector) { return length(world_vector(texture_vector)); }

vec3 unproject(vec3 clip) {
    vec4 p = u_clip_to_texture * vec4(clip, 1.0);
    return p.xyz / p.w;
}

// World length along the ray at which opaque geometry lies; a very large number where there is none.
float scene_distance(Ray ray, vec2 ndc) {
#if SCENE_DEPTH
    float depth = textureLod(t_scene_depth, ndc * 0.5 + 0.5, 0.0).r;
    if (depth >= 1.0) return 1e30;
    return world_length(unproject(vec3(ndc, depth * 2.0 - 1.0)) - ray.origin);
#else
    return 1e30;
#endif
}

// The ray from the near plane on, uncut.
Ray unclipped_ray(vec2 ndc) {
    Ray ray;
    ray.origin = unproject(vec3(ndc, -1.0));
    vec3 to_far_plane = unproject(vec3(ndc, 1.0)) - ray.origin;
    ray.direction = to_far_plane / world_length(to_far_plane);
    ray.near = 0.0;
    ray.far = 1e30;
    return ray;
}

// The ray through a point of the image (normalised device coordinates), cut by box, planes and scene depth.
Ray make_ray(vec2 ndc) {
    Ray ray = unclipped_ray(ndc);
    intersect_box(ray);
    intersect_planes(ray);
    ray.far = min(ray.far, scene_distance(ray, ndc));
    return ray;
}

// Window depth 0..1 of a point in texture coordinates.
float window_depth(vec3 p) {
    vec4 clip = u_texture_to_clip * vec4(p, 1.0);
    return clamp(0.5 * clip.z / clip.w + 0.5, 0.0, 1.0);
}
