// Pixels of a triangle mesh: cut, coloured and lit.
#include "shade/lit.glsl"
#if COLOR_TRANSFER_FUNCTION
#include "sampling.glsl"
#include "classification.glsl"
uniform mat4 u_world_to_texture;
uniform float u_color_depth;          // world units below the surface
#endif
#if CUT
#include "clipping.glsl"
#endif
#if SCENE_DEPTH
uniform sampler2D t_scene_depth;      // window depth of opaque geometry
uniform vec2 u_size;                  // of this image, pixels
#endif
uniform vec3 u_surface_color;
uniform bool u_mirrored;              // index axes are left-handed in the world: triangles turn the other way

#if COLOR_VALUE
uniform sampler2D t_value_colors;     // one row
in float v_value;
#endif
in vec3 v_point;
#if FACETS
in vec3 v_offset;
#else
in vec3 v_normal;
#endif
out vec4 f_color;

// Unit normal in the world, to the side of lower values; zero where there is none.
vec3 surface_normal() {
#if FACETS
    // right times up on the screen points to the eye
    vec3 to_eye = cross(dFdx(v_offset), dFdy(v_offset));
    float size = length(to_eye);
    vec3 n = size > 0.0 ? to_eye / size : vec3(0.0);
    return gl_FrontFacing != u_mirrored ? n : -n;
#else
    float size = length(v_normal);
    return size > 0.0 ? v_normal / size : vec3(0.0);
#endif
}

void main() {
    // before anything is discarded: derivatives need the neighbours
    vec3 normal = surface_normal();
#if CUT
    if (is_cropped(v_point) || is_clipped(v_point)) discard;
#endif
#if SCENE_DEPTH
    if (gl_FragCoord.z > textureLod(t_scene_depth, gl_FragCoord.xy / u_size, 0.0).r) discard;
#endif
#if COLOR_NORMAL
    f_color = vec4(0.5 + 0.5 * normal, 1.0);
#else
    vec3 color = u_surface_color;
#if COLOR_VALUE
    color = textureLod(t_value_colors, vec2(v_value, 0.5), 0.0).rgb;
#endif
#if COLOR_TRANSFER_FUNCTION
    color = curve_color(sample_scalar(v_point - mat3(u_world_to_texture) * (u_color_depth * normal))).rgb;
#endif
    // a direction has no size that rounding could be told from: any but zero is lit
    f_color = vec4(shade(color, 2.0 * u_flat_gradient * normal, v_point), 1.0);
#endif
}
