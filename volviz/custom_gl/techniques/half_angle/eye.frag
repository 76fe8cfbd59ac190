// A slice as the eye sees it, lit by what the slices before it have left of the light.
#include "slab.glsl"
#include "lighting.glsl"
#include "noise.glsl"

uniform vec2 u_size;
uniform vec4 u_eye_from;               // the eye in texture coordinates, w = 0: parallel projection
uniform mat4 u_texture_to_light;       // clip space of the light
uniform sampler2D t_light;             // light that reaches this slice
uniform float u_ambient;
uniform float u_scattering;            // 0..1
uniform float u_first_sample;
uniform bool u_jitter;
uniform float u_jitter_seed;

in vec3 v_texture;
out vec4 f_color;

// Radius of the disc from which scattered light comes, as a share of the light buffer.
const float SCATTERING_RADIUS = 0.04;
const int SCATTERING_TAPS = 12;

vec3 light_at(vec3 p) {
    vec4 clip = u_texture_to_light * vec4(p, 1.0);
    vec2 uv = clip.xy / clip.w * 0.5 + 0.5;
    vec3 light = textureLod(t_light, uv, 0.0).rgb;
#if SCATTERING
    vec3 scattered = vec3(0.0);
    // a spiral that fills the disc evenly (Vogel 1979)
    for (int i = 0; i < SCATTERING_TAPS; ++i) {
        float radius = SCATTERING_RADIUS * sqrt((float(i) + 0.5) / float(SCATTERING_TAPS));
        float angle = 2.399963 * float(i);
        scattered += textureLod(t_light, uv + radius * vec2(cos(angle), sin(angle)), 0.0).rgb;
    }
    light = mix(light, scattered / float(SCATTERING_TAPS), u_scattering);
#endif
    return light;
}

#if LABELS
// The segment of a ray with the surfaces of labels in it, and the faces of those that are cut where it begins.
vec4 with_labels(Ray ray, vec3 color) {
    layers_begin(0.0);
    take_labels(ray);
#pragma each_label
#if MODE == 0
    if (begins_in_slab(ray)) {
        vec4 face = look_of(g_label);
        vec3 light = light_at(ray.origin + ray.near * ray.direction);
        blend(face.rgb * (u_ambient + (1.0 - u_ambient) * u_light_color * light), face.a);
    }
#endif
#pragma end
    take_borders(ray);
    float begin = begin_of_borders(ray);
#pragma each_label
#if MODE == 0
    if (g_border < 1e29) {
        vec3 dark = u_ambient * look_of(g_owner).rgb;
        vec3 light = light_at(ray.origin + (begin + g_border) * ray.direction);
        g_surface.rgb = dark + light * (g_surface.rgb - dark);
    }
#endif
#pragma end
    blend_segment(vec4(color, 1.0) * extinction_of_matter(), ray.far - ray.near);
    return layers_end();
}
#endif

void main() {
    Ray ray = slab_ray(u_eye_from, v_texture);
#if SCENE_DEPTH || EYE_INSIDE
    vec2 window = gl_FragCoord.xy / u_size;
#endif
#if EYE_INSIDE
    vec3 to_near_plane = unproject(vec3(window * 2.0 - 1.0, -1.0)) - v_texture;
    ray.near = max(ray.near, dot(world_vector(to_near_plane), world_vector(ray.direction)));
#endif
#if SCENE_DEPTH
    float depth = textureLod(t_scene_depth, window, 0.0).r;
    vec3 to_scene = unproject(vec3(window, depth) * 2.0 - 1.0) - v_texture;
    if (depth < 1.0) ray.far = min(ray.far, dot(world_vector(to_scene), world_vector(ray.direction)));
#endif
    float segment = ray.far - ray.near;
    if (!(segment > 0.0)) discard;
    float fraction = u_jitter ? pixel_noise(gl_FragCoord.xy, u_jitter_seed) : u_first_sample;
    float at = ray.near + fraction * segment;
    vec3 p = ray.origin + at * ray.direction;
    take_matter(ray, at);
    vec3 light = light_at(p);
#if !CLASSIC_LIGHT
    // the buffer holds the light at the slab's near face; the sample lies deeper
    vec3 light_ray = world_vector(u_light_from.w * p - u_light_from.xyz);
    float behind = 0.5 * u_slab - dot(world_vector(p - v_texture), u_half_vector);
    light *= transmitted(max(behind, 0.0) * slant(light_ray));
#endif
    vec3 color = unlit_matter();
#if SHADING
    vec3 dark = u_ambient * color;
    color = dark + light * (lit_matter() - dark);
#else
    color = color * (u_ambient + (1.0 - u_ambient) * u_light_color * light);
#endif
#if LABELS
    f_color = with_labels(ray, color);
#else
    float a = matter_opacity(segment);
    f_color = vec4(color * a, a);
#endif
}
