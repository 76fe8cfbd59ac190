// Triangles of an isosurface, in voxel indices of the volume.
uniform mat4 u_index_to_clip;
uniform vec3 u_index_to_texture_scale;
uniform vec3 u_index_to_texture_offset;
uniform mat3 u_gradient_to_world;     // gradient per voxel along the index axes -> gradient per world unit
uniform mat3 u_index_to_world_vector;
uniform vec3 u_near_index;            // a point near the eye

in vec3 a_index;
#if COLOR_VALUE
uniform float u_value_scale;          // value -> place in the table of colours
uniform float u_value_offset;
in float a_value;
out float v_value;                    // place in the table of colours, 0..1 is inside
#endif
in vec3 a_normal;                     // falling gradient per voxel, unit length or zero
out vec3 v_point;                     // texture coordinates
#if FACETS
out vec3 v_offset;                    // world, from the point near the eye: keeps its digits however near the eye is
#else
out vec3 v_normal;                    // world, unit length or zero
#endif

void main() {
    gl_Position = u_index_to_clip * vec4(a_index, 1.0);
#if COLOR_VALUE
    v_value = a_value * u_value_scale + u_value_offset;
#endif
    v_point = a_index * u_index_to_texture_scale + u_index_to_texture_offset;
#if FACETS
    v_offset = u_index_to_world_vector * (a_index - u_near_index);
#else
    vec3 normal = u_gradient_to_world * a_normal;
    float size = length(normal);
    v_normal = size > 0.0 ? normal / size : vec3(0.0);
#endif
}
