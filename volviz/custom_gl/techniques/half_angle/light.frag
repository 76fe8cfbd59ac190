// A slice as the light sees it: what it lets pass.
#include "slab.glsl"

in vec3 v_texture;
out vec4 f_color;

void main() {
    Ray ray = slab_ray(u_light_from, v_texture);
    float segment = ray.far - ray.near;
    if (!(segment > 0.0)) discard;
    take_matter(ray, 0.5 * (ray.near + ray.far));
#if LABELS
    float passing = light_past_surfaces(ray);
#endif
#if CLASSIC_LIGHT
#if LABELS
    float a = 1.0 - passing * (1.0 - matter_opacity(segment));
#else
    float a = matter_opacity(segment);
#endif
    f_color = vec4(u_kappa * a, a);
#else
    f_color = vec4(transmitted(segment), 1.0);
#if LABELS
    f_color.rgb *= exp(u_kappa * log(max(passing, 1e-37)));
#endif
#endif
}
