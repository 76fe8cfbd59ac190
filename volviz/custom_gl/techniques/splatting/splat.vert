// A splat: placed, lit and coloured once, as a point of the right size or as a quad where points would not do.
#include "classification.glsl"
#include "lighting.glsl"
#include "clipping.glsl"

uniform mat4 u_index_to_centred;
uniform mat4 u_index_to_clip;
uniform vec3 u_index_to_texture_scale;
uniform vec3 u_index_to_texture_offset;
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
out vec2 v_position;                    // -1..1
#endif

const vec3 CLASSIC_COLOR = vec3(0.75, 0.5, 0.5);
// A Gaussian smaller than this would fall between the pixels.
const float SMALLEST_GAUSSIAN = 2.5;

void main() {
    vec4 clip = u_index_to_clip * vec4(a_index, 1.0);
    vec4 classified = curve_color(a_value);
    vec3 color = u_classic_color ? CLASSIC_COLOR : classified.rgb;
#if SHADING
    // a direction has no size that rounding could be told from: any but zero is lit
    vec3 normal = 2.0 * u_flat_gradient * a_normal;
    float size = length(normal);
    if (size > u_flat_gradient) {
        color = lit_color(color, normal / size, (u_index_to_centred * vec4(a_index, 1.0)).xyz, 1.0);
    }
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
    vec3 p = a_index * u_index_to_texture_scale + u_index_to_texture_offset;
    if (!seen || !(clip.w > 0.0) || is_cropped(p) || is_clipped(p)) clip = vec4(2.0, 2.0, 2.0, 1.0);
    v_pixels = pixels;
#if QUADS
    v_position = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
    clip.xy += v_position * pixels / u_size * clip.w;
#else
    gl_PointSize = pixels;
#endif
    gl_Position = clip;
}
