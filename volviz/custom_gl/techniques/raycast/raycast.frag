// Single-pass ray casting: one march per pixel, from the box's entry to its exact exit.
#include <march>

in vec2 v_ndc;
out vec4 f_color;

void main() {
    Ray ray = make_ray(v_ndc);
    if (!(ray.far > ray.near)) discard;
    f_color = march(ray, gl_FragCoord.xy);
}
