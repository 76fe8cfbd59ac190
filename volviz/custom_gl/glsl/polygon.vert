// A vertex of the polygon in which a plane cuts the volume, in texture coordinates: world coordinates far from the origin
// would lose precision.
uniform mat4 u_texture_to_clip;

in vec3 a_position;
out vec3 v_texture;

void main() {
    v_texture = a_position;
    gl_Position = u_texture_to_clip * vec4(a_position, 1.0);
}
