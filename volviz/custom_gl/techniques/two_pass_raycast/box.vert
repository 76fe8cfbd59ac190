// The (cropped) box of the volume as twelve triangles, made from the vertex number alone.
//
// Corners are numbered by bits: 1 = x, 2 = y, 4 = z. Triangles run counter-clockwise seen from outside in a
// right-handed volume.

uniform mat4 u_texture_to_clip;
uniform vec3 u_box_low;
uniform vec3 u_box_high;

out vec3 v_position;   // texture coordinates

const int CORNERS[36] = int[36](
    0, 4, 6, 0, 6, 2,   1, 3, 7, 1, 7, 5,    // -x, +x
    0, 1, 5, 0, 5, 4,   2, 6, 7, 2, 7, 3,    // -y, +y
    0, 2, 3, 0, 3, 1,   4, 5, 7, 4, 7, 6);   // -z, +z

void main() {
    int corner = CORNERS[gl_VertexID];
    vec3 part = vec3(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
    v_position = mix(u_box_low, u_box_high, part);
    vec4 clip = u_texture_to_clip * vec4(v_position, 1.0);
    // no depth is needed, and with none the near and far planes cut nothing off: rays are cut by the second pass
    gl_Position = vec4(clip.xy, 0.0, clip.w);
}
