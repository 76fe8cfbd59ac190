// A splat: placed, lit and coloured once, as a point of the right size or as a quad where points would not do.
#include "classification.glsl"
#include "lighting.glsl"

uniform mat4 u_index_to_place;     // world units from the middle of the volume
uniform mat4 u_index_to_clip;
uniform vec3 u_crop_low;             // voxel indices
uniform vec3 u_crop_high;
uniform int u_plane_count;
uniform vec4 u_index_planes[6];      // dot(plane.xyz, index) + plane.w >= 0 is kept
uniform float u_diameter;            // world units
uniform float u_pixels_per_unit;     // at w = 1
uniform vec2 u_size;
uniform bool u_classic_color;
uniform float u_depth_per_extinction; // optical depth through the middle of a Gaussian of extinction 1

in vec3 a_index;
in vec3 a_normal;
in float a_value;                    // fraction of the data range

flat out vec4 v_color;               // straight colour; Gaussian: optical depth in the middle
flat out float v_pixels;
#if QUADS
out vec2 v_place;                    // -1..1
#endif

const vec3 CLASSIC_COLOR = vec3(0.75, 0.5, 0.5);
// A Gaussian smaller than this would fall between the pixels.
const float SMALLEST_GAUSSIAN = 2.5;

bool is_kept() {
    if (any(lessThan(a_index, u_crop_low)) || any(greaterThan(a_index, u_crop_high))) return false;
    for (int i = 0; i < u_plane_count; ++i) {
        if (dot(u_index_planes[i].xyz, a_index) + u_index_planes[i].w < 0.0) return false;
    }
    return true;
}

void main() {
    vec4 clip = u_index_to_clip * vec4(a_index, 1.0);
    vec4 classified = classify(a_value);
    vec3 color = u_classic_color ? CLASSIC_COLOR : classified.rgb;
#if SHADING
    color = lit_color(color, 2.0 * u_flat_gradient * a_normal, (u_index_to_place * vec4(a_index, 1.0)).xyz);
#endif
    float pixels = u_diameter * u_pixels_per_unit / clip.w;
    v_color = vec4(color, 1.0);
#if GAUSSIAN
    float drawn = max(pixels, SMALLEST_GAUSSIAN);
    v_color.a = extinction(classified.a) * u_depth_per_extinction * (pixels * pixels) / (drawn * drawn);
    pixels = drawn;
    bool seen = v_color.a > 0.0;
#else
    pixels = max(pixels, 1.0);
    bool seen = true;
#endif
    if (!seen || !(clip.w > 0.0) || !is_kept()) clip = vec4(2.0, 2.0, 2.0, 1.0);
    v_pixels = pixels;
#if QUADS
    v_place = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
    clip.xy += v_place * pixels / u_size * clip.w;
#else
    gl_PointSize = pixels;
#endif
    gl_Position = clip;
}
