// A slice as the light sees it: what it lets pass.
#include "slab.glsl"

in vec3 v_texture;
out vec4 f_color;

void main() {
    Ray ray = slab_ray(u_light_from, v_texture);
    float segment = ray.far - ray.near;
    if (!(segment > 0.0)) discard;
    vec3 gradient;
    vec4 c = slab_sample(ray.origin + 0.5 * (ray.near + ray.far) * ray.direction, gradient);
#if CLASSIC_LIGHT
    float a = corrected_opacity(c.a, segment);
    f_color = vec4(u_kappa * a, a);
#else
    f_color = vec4(transmitted(c, segment), 1.0);
#endif
}
