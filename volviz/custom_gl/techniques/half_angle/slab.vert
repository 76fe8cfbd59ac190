// A corner of a slice polygon, in texture coordinates; the same slices are drawn for the eye and for the light.
uniform mat4 u_texture_to_pass;   // to the clip space of the pass

in vec3 a_texture;
out vec3 v_texture;

void main() {
    v_texture = a_texture;
    gl_Position = u_texture_to_pass * vec4(a_texture, 1.0);
#if !CLIPS_DEPTH
    gl_Position.z = 0.0;
#endif
}
