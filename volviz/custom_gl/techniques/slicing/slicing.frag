// A fragment of a slice, which stands for a segment of its ray. What is seen of the segment is the hook <samples>, which
// must define
//     vec4 segment_color(vec3 p, vec3 direction, float front, float back, bool begins, bool ends)
//         the colour to be blended; may discard. p = the sample in texture coordinates, direction = their change per world
//         unit along the ray, front and back = how far the segment reaches before and behind p, world units; begins,
//         ends = it is the first, the last one of the ray
// Where it is made of one sample, that is the hook <blend>, which must define
//     vec4 slice_color(float s, vec3 p, float segment_length)
//         the same of the scalar s at p
// It may read what layer.glsl declares.
#include "clipping.glsl"
#include "noise.glsl"

uniform vec2 u_size;
uniform vec3 u_view_direction;
uniform float u_slice_distance;    // between slices, world units
uniform bool u_perspective;
uniform vec3 u_direction_texture;  // the view direction as a change of texture coordinates per world unit
uniform vec3 u_eye_texture;        // the eye in texture coordinates
uniform vec4 u_near_plane;         // dot(plane.xyz, texture coordinate) + plane.w >= 0 lies behind it
uniform mat3 u_texture_to_world_vector;
uniform bool u_jitter;
uniform float u_jitter_seed;
#if SCENE_DEPTH
uniform sampler2D t_scene_depth;
uniform mat4 u_clip_to_texture;
#endif

in vec3 v_texture;
out vec4 f_color;

#include <samples>

void main() {
    vec3 p = v_texture;
    // the ray: a change of texture coordinates per world unit, and the same in the world
    vec3 direction = u_direction_texture, world_direction = u_view_direction;
    if (u_perspective) {
        direction = p - u_eye_texture;
        world_direction = u_texture_to_world_vector * direction;
        float inverse_length = 1.0 / length(world_direction);
        direction *= inverse_length;
        world_direction *= inverse_length;
    }
    // a slice that is seen at an angle stands for a longer segment of the ray
    float segment = u_slice_distance / max(dot(world_direction, u_view_direction), 1e-3);
    if (u_jitter) p += direction * (segment * (pixel_noise(gl_FragCoord.xy, u_jitter_seed) - 0.5));
    // how far the ray is shown: from where it entered the box, or began within, to here, and from here on
    Ray ray = Ray(p, direction, -1e30, 1e30);
    intersect_planes(ray);
    if (ray.near > 0.0 || ray.far < 0.0) discard;
    intersect_box(ray);
    float before = min(-ray.near, (dot(u_near_plane.xyz, p) + u_near_plane.w) / dot(u_near_plane.xyz, direction));
    float behind = ray.far;
#if SCENE_DEPTH
    vec2 uv = gl_FragCoord.xy / u_size;
    float depth = textureLod(t_scene_depth, uv, 0.0).r;
    if (gl_FragCoord.z > depth) discard;
    if (depth < 1.0) {
        vec4 opaque = u_clip_to_texture * vec4(2.0 * vec3(uv, depth) - 1.0, 1.0);
        behind = min(behind, length(u_texture_to_world_vector * (opaque.xyz / opaque.w - p)));
    }
#endif
    // the first and the last slice of a ray stand for all of it up to where it enters and leaves
    bool begins = before < segment, ends = behind < segment;
    float front = begins ? max(before, 0.0) : 0.5 * segment;
    float back = ends ? max(behind, 0.0) : 0.5 * segment;
    f_color = segment_color(p, direction, front, back, begins, ends);
}
