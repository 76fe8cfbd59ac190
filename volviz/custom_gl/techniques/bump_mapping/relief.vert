// A vertex of a surface with its tangent space. Positions are relative to the middle of the volume, world units.
#define VERTEX_STAGE 1
#include "tangent_space.glsl"

uniform mat4 u_relative_to_clip;
uniform mat4 u_relative_to_texture;
uniform vec3 u_relative_light;
uniform vec3 u_relative_eye;
uniform float u_tiles_per_world;

in vec3 a_position;
in vec3 a_normal;
in vec4 a_tangent;   // w: sign of the binormal
in vec2 a_uv;        // world units

out vec3 v_texture;
out vec2 v_uv;       // tiles
out vec3 v_tangent;
out vec3 v_binormal;
out vec3 v_normal;
out vec3 v_light;    // towards the light, in tangent space, world length
#if VERTEX_LIGHTING
out float v_intensity;
#endif
invariant gl_Position;   // both passes of one surface meet the same depth

void main() {
    vec3 n = a_normal, t = a_tangent.xyz;
    vec3 b = a_tangent.w * cross(n, t);
    vec3 l = u_relative_light - a_position;
    vec4 position = vec4(a_position, 1.0);
    v_texture = (u_relative_to_texture * position).xyz;
    v_uv = a_uv * u_tiles_per_world;
    v_tangent = t;
    v_binormal = b;
    v_normal = n;
    v_light = vec3(dot(t, l), dot(b, l), dot(n, l));
#if VERTEX_LIGHTING
    float facing = dot(n, u_relative_eye - a_position);   // above 0: the eye is on the side of the normal
    v_intensity = intensity(tangent_normal(v_texture, v_uv, t, b, n, facing), v_light);
#endif
    gl_Position = u_relative_to_clip * position;
}
