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
uniform vec3 u_direction_texture;  // the view direction as a change of texture coordinates per world unit
uniform vec3 u_eye_texture;        // the eye in texture coordinates
uniform vec3 u_box_low;            // the (cropped) box in texture coordinates
uniform vec3 u_box_high;
uniform vec4 u_near_plane;         // dot(plane.xyz, texture coordinate) + plane.w >= 0 lies behind it
uniform mat3 u_texture_to_world_vector;
uniform bool u_jitter;
uniform float u_jitter_seed;
uniform int u_plane_count;
uniform vec4 u_planes[6];
#if SCENE_DEPTH
uniform sampler2D t_scene_depth;
uniform mat4 u_clip_to_texture;
#endif

in vec3 v_texture;
out vec4 f_color;

#include <blend>

void main() {
    vec3 p = v_texture;
    // along the ray: a change of texture coordinates per world unit, and the same in the world
    vec3 direction = u_direction_texture, along = u_view_direction;
    if (u_perspective) {
        direction = p - u_eye_texture;
        along = u_texture_to_world_vector * direction;
        float way = 1.0 / length(along);
        direction *= way;
        along *= way;
    }
    // a slice that is seen at an angle stands for a longer piece of ray
    float piece = u_slice_distance / max(dot(along, u_view_direction), 1e-3);
    if (u_jitter) p += direction * (piece * (pixel_noise(gl_FragCoord.xy, u_jitter_seed) - 0.5));
    // how far the ray is shown: from where it entered the box, or began within, to here, and from here on
    vec3 inverse = 1.0 / (direction + vec3(equal(direction, vec3(0.0))) * 1e-20);
    vec3 a = (u_box_low - p) * inverse, b = (u_box_high - p) * inverse;
    vec3 low = min(a, b), high = max(a, b);
    float before = -max(low.x, max(low.y, low.z)), behind = min(high.x, min(high.y, high.z));
    before = min(before, (dot(u_near_plane.xyz, p) + u_near_plane.w) / dot(u_near_plane.xyz, direction));
    for (int i = 0; i < u_plane_count; ++i) {
        float height = dot(u_planes[i].xyz, p) + u_planes[i].w;
        if (height < 0.0) discard;
        float slope = dot(u_planes[i].xyz, direction);
        if (slope > 0.0) before = min(before, height / slope);
        else if (slope < 0.0) behind = min(behind, -height / slope);
    }
#if SCENE_DEPTH
    vec2 place = gl_FragCoord.xy / u_size;
    float depth = textureLod(t_scene_depth, place, 0.0).r;
    if (gl_FragCoord.z > depth) discard;
    if (depth < 1.0) {
        vec4 opaque = u_clip_to_texture * vec4(2.0 * vec3(place, depth) - 1.0, 1.0);
        behind = min(behind, length(u_texture_to_world_vector * (opaque.xyz / opaque.w - p)));
    }
#endif
    float s = sample_scalar(p);
    if (s < u_density_threshold) discard;
    // the first and the last slice of a ray stand for all of it up to where it enters and leaves
    float reach = (before < piece ? max(before, 0.0) : 0.5 * piece) + (behind < piece ? max(behind, 0.0) : 0.5 * piece);
    f_color = slice_color(s, p, reach);
}
