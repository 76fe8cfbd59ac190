// A fragment of a surface: colour factor times light.
//
// PASS 0 draws both at once. PASS 1 draws the light alone, and PASS 2 the colour factor, which is multiplied on top of
// it by the blend function (DST_COLOR, ZERO); what reaches the target is the same.
#define VERTEX_STAGE 0
#include "tangent_space.glsl"
#include "classification.glsl"
#include "clipping.glsl"

uniform vec2 u_size;
uniform vec3 u_light_color;
uniform vec2 u_lighting;      // ambient, diffuse
uniform vec3 u_flat_color;
#if SCENE_DEPTH
uniform sampler2D t_scene_depth;
#endif

in vec3 v_texture;
in vec2 v_uv;
in vec3 v_tangent;
in vec3 v_binormal;
in vec3 v_normal;
in vec3 v_light;
#if VERTEX_LIGHTING
in float v_intensity;
#endif
out vec4 f_color;

// Opacity of the transfer function from which on a surface is shown fully; below, its edge fades out.
const float SHOWN = 0.005;
const float GAIN = 32.0;

#define DISPLAY_IMAGE 0
#define DISPLAY_DIFFUSE 1
#define DISPLAY_COLOR 2
#define DISPLAY_NORMALS 3
#define DISPLAY_LIGHT 4
#define DISPLAY_DIFFERENCE 5

// Colour and opacity of the point itself, before any light.
vec4 surface_color(vec3 p) {
    vec4 surface = vec4(u_flat_color, 1.0);
#if MESH && !MESH_FILE
    // a coarse triangle lies beside the surface: its colour is that of the isovalue
#if COLOR_TABLE
    surface.rgb = curve_color(max(u_mesh_fraction, u_density_threshold)).rgb;
#endif
#else
    float s = sample_scalar(p);
    vec4 c = curve_color(s);
#if COLOR_TABLE
    surface.rgb = c.rgb;
#endif
#if !MESH
#if CUT_OUT
    surface.a = clamp(c.a / SHOWN, 0.0, 1.0);
#endif
    if (s < u_density_threshold) surface.a = 0.0;
#endif
#endif
    return surface;
}

void main() {
    vec3 p = v_texture;
    // before anything is discarded: neighbouring pixels tell how fine the map is looked up
    vec3 n = tangent_normal(p, v_uv, v_tangent, v_binormal, v_normal, gl_FrontFacing ? 1.0 : -1.0);
    if (is_clipped(p)) discard;
#if MESH
    // flat surfaces are cut with the box beforehand
    if (is_cropped(p)) discard;
#endif
#if SCENE_DEPTH
    if (gl_FragCoord.z > textureLod(t_scene_depth, gl_FragCoord.xy / u_size, 0.0).r) discard;
#endif
    vec4 surface = surface_color(p);
    if (surface.a <= 0.0) discard;

#if VERTEX_LIGHTING
    float product = v_intensity;
#else
    float product = intensity(n, v_light);
#endif
    vec3 light = clamp(u_lighting.x + u_lighting.y * product * u_light_color, 0.0, 1.0);
#if DISPLAY == DISPLAY_DIFFUSE
    surface.rgb = vec3(1.0);
    light = vec3(product);
#elif DISPLAY == DISPLAY_COLOR
    light = vec3(1.0);
#elif DISPLAY == DISPLAY_NORMALS
    surface.rgb = vec3(1.0);
    light = vector_color(n);
#elif DISPLAY == DISPLAY_LIGHT
    surface.rgb = vec3(1.0);
    light = vector_color(light_direction(v_light));
#elif DISPLAY == DISPLAY_DIFFERENCE
    surface.rgb = vec3(1.0);
    light = clamp(GAIN * abs(looked_up(v_light) - normalize(v_light)), 0.0, 1.0);
#endif
    vec3 premultiplied = light * surface.a;
#if DOT3_ALPHA
    // the light is the opacity as well, and the lit colour premultiplied by it
    surface.a *= max(light.r, max(light.g, light.b));
    if (surface.a <= 0.0) discard;
#endif
#if PASS == 2
    f_color = vec4(surface.rgb, 1.0);
#elif PASS == 1
    f_color = vec4(premultiplied, surface.a);
#else
    f_color = vec4(surface.rgb * premultiplied, surface.a);
#endif
}
