// A piece of a slice. What becomes of its sample is the hook <blend>, which must define
//     vec4 slice_color(float s, vec3 p, float length)   the colour to be blended; may discard
#include "sampling.glsl"
#include "classification.glsl"
#include "lighting.glsl"
#include "noise.glsl"

uniform vec2 u_size;
uniform vec3 u_view_direction;
uniform float u_slice_distance;    // between slices, world units
uniform bool u_perspective;
uniform mat4 u_world_to_texture;
uniform vec3 u_eye_texture;        // the eye in texture coordinates
uniform mat3 u_texture_to_world_vector;
uniform bool u_jitter;
uniform float u_jitter_seed;
uniform int u_plane_count;
uniform vec4 u_planes[6];
#if SCENE_DEPTH
uniform sampler2D t_scene_depth;
#endif

in vec3 v_texture;
out vec4 f_color;

#include <blend>

void main() {
    vec3 p = v_texture;
    // a slice that is seen at an angle stands for a longer piece of ray
    vec3 along = u_perspective ? normalize(u_texture_to_world_vector * (p - u_eye_texture)) : u_view_direction;
    float piece = u_slice_distance / max(dot(along, u_view_direction), 1e-3);
    if (u_jitter) {
        p += (u_world_to_texture * vec4(along * (piece * (pixel_noise(gl_FragCoord.xy, u_jitter_seed) - 0.5)), 0.0)).xyz;
    }
    for (int i = 0; i < u_plane_count; ++i) {
        if (dot(u_planes[i].xyz, p) + u_planes[i].w < 0.0) discard;
    }
#if SCENE_DEPTH
    if (gl_FragCoord.z > textureLod(t_scene_depth, gl_FragCoord.xy / u_size, 0.0).r) discard;
#endif
    float s = sample_scalar(p);
    if (s < u_density_threshold) discard;
    f_color = slice_color(s, p, piece);
}
