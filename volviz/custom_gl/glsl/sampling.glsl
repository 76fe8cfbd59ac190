// Scalars of the volume as fractions of the range of the bulk of its values (Volume.bulk_range), and their gradient.
// They lie within 0..1 unless there are outliers. Everything is read through the hook
// <fetch>, which must define
//     float fetch(vec3 p)   the stored value at a point in texture coordinates of the volume (0..1, voxel centres at
//                           (i + 0.5) / N), linear between voxel centres, the nearest one's outside; in the unit of the
//                           store, which u_scalar_map takes to fractions
// It may read samplers and uniforms of its own, and u_voxels.
#pragma per_layer

uniform vec2 u_scalar_map;          // fraction = stored value * x + y
uniform vec3 u_voxels;              // number of voxels along each axis
uniform mat3 u_gradient_to_world;   // gradient per voxel along the index axes -> gradient per world unit
uniform float u_gradient_delta;     // voxels

#include <fetch>

float sample_scalar(vec3 p) {
#if NEAREST
    p = (floor(p * u_voxels) + 0.5) / u_voxels;
#endif
    return fetch(p) * u_scalar_map.x + u_scalar_map.y;
}

// Central differences along the index axes, in fractions per voxel.
vec3 index_gradient(vec3 p, float delta) {
    vec3 d = delta / u_voxels;
    vec3 high = vec3(fetch(p + vec3(d.x, 0.0, 0.0)), fetch(p + vec3(0.0, d.y, 0.0)), fetch(p + vec3(0.0, 0.0, d.z)));
    vec3 low = vec3(fetch(p - vec3(d.x, 0.0, 0.0)), fetch(p - vec3(0.0, d.y, 0.0)), fetch(p - vec3(0.0, 0.0, d.z)));
    return (high - low) * (u_scalar_map.x / (2.0 * delta));
}

// Gradient in the world: fractions per world unit.
vec3 world_gradient(vec3 p) {
    return u_gradient_to_world * index_gradient(p, u_gradient_delta);
}
