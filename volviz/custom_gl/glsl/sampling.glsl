// Scalars of the volume as fractions 0..1 of the data range, and their gradient.

uniform sampler3D t_scalars;
uniform vec2 u_scalar_map;          // fraction of the range = texel * x + y
uniform vec3 u_voxels;              // number of voxels along each axis
uniform mat3 u_gradient_to_world;   // gradient per voxel along the index axes -> gradient per world unit
uniform float u_gradient_delta;     // voxels

float sample_scalar(vec3 p) {
#if NEAREST
    p = (floor(p * u_voxels) + 0.5) / u_voxels;
#endif
    return textureLod(t_scalars, p, 0.0).r * u_scalar_map.x + u_scalar_map.y;
}

// Central differences along the index axes, in fractions of the data range per voxel.
vec3 index_gradient(vec3 p, float delta) {
    vec3 d = delta / u_voxels;
    vec3 high = vec3(textureLod(t_scalars, p + vec3(d.x, 0.0, 0.0), 0.0).r,
                     textureLod(t_scalars, p + vec3(0.0, d.y, 0.0), 0.0).r,
                     textureLod(t_scalars, p + vec3(0.0, 0.0, d.z), 0.0).r);
    vec3 low = vec3(textureLod(t_scalars, p - vec3(d.x, 0.0, 0.0), 0.0).r,
                    textureLod(t_scalars, p - vec3(0.0, d.y, 0.0), 0.0).r,
                    textureLod(t_scalars, p - vec3(0.0, 0.0, d.z), 0.0).r);
    return (high - low) * (u_scalar_map.x / (2.0 * delta));
}

// Gradient in the world: fractions of the data range per world unit.
vec3 world_gradient(vec3 p) {
    return u_gradient_to_world * index_gradient(p, u_gradient_delta);
}
