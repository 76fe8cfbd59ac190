// A vertex of a slice polygon, in world space.
uniform mat4 u_view_projection;
uniform mat4 u_world_to_texture;

in vec3 a_position;
out vec3 v_texture;
out vec3 v_world;

void main() {
    v_world = a_position;
    v_texture = (u_world_to_texture * vec4(a_position, 1.0)).xyz;
    gl_Position = u_view_projection * vec4(a_position, 1.0);
}
