// The ray of a fragment, and the part of it that is to be shown.
//
// Rays are marched in *texture coordinates* of the volume (0..1, voxel centres at (i + 0.5) / N); the parameter t along
// a ray is a length in *world units*, whatever the spacing, direction or shear of the lattice.

uniform mat4 u_clip_to_texture;    // clip space -> texture coordinates
uniform mat4 u_texture_to_clip;    // its inverse
uniform vec3 u_world_metric_x;     // rows of the matrix that takes texture-coordinate vectors to world vectors
uniform vec3 u_world_metric_y;
uniform vec3 u_world_metric_z;
uniform vec3 u_box_low;            // the (cropped) box in texture coordinates
uniform vec3 u_box_high;
uniform int u_plane_count;
uniform vec4 u_planes[6];          // clip planes: dot(plane.xyz, texture coordinate) + plane.w >= 0 is kept
#if SCENE_DEPTH
uniform sampler2D t_scene_depth;   // window depth of opaque geometry
#endif

struct Ray {
    vec3 origin;      // texture coordinates of the point on the near plane
    vec3 direction;   // change of texture coordinates per world unit
    float near;       // world length from the origin to the first shown point
    float far;        // ... to the last one; nothing is shown when far <= near
};

float world_length(vec3 texture_vector) {
    return length(vec3(dot(u_world_metric_x, texture_vector), dot(u_world_metric_y, texture_vector),
                       dot(u_world_metric_z, texture_vector)));
}

vec3 unproject(vec3 clip) {
    vec4 p = u_clip_to_texture * vec4(clip, 1.0);
    return p.xyz / p.w;
}

// Entry and exit of the box, as world lengths along the ray (slabs method, Kay & Kajiya 1986).
void intersect_box(inout Ray ray) {
    vec3 inverse = 1.0 / (ray.direction + vec3(equal(ray.direction, vec3(0.0))) * 1e-20);
    vec3 a = (u_box_low - ray.origin) * inverse;
    vec3 b = (u_box_high - ray.origin) * inverse;
    vec3 low = min(a, b), high = max(a, b);
    ray.near = max(ray.near, max(low.x, max(low.y, low.z)));
    ray.far = min(ray.far, min(high.x, min(high.y, high.z)));
}

void intersect_planes(inout Ray ray) {
    for (int i = 0; i < u_plane_count; ++i) {
        float start = dot(u_planes[i].xyz, ray.origin) + u_planes[i].w;
        float slope = dot(u_planes[i].xyz, ray.direction);
        if (slope > 0.0) ray.near = max(ray.near, -start / slope);
        else if (slope < 0.0) ray.far = min(ray.far, -start / slope);
        else if (start < 0.0) ray.far = ray.near;
    }
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

Ray unclipped_ray(vec2 ndc) {
    Ray ray;
    ray.origin = unproject(vec3(ndc, -1.0));
    vec3 along = unproject(vec3(ndc, 1.0)) - ray.origin;
    ray.direction = along / world_length(along);
    ray.near = 0.0;
    ray.far = 1e30;
    return ray;
}

// The ray through a point of the picture (normalised device coordinates), cut by box, planes and scene depth.
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
