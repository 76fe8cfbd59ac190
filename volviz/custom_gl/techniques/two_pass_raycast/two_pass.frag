// Second pass: the other faces of the box. The fragment knows one end of its ray, the first pass's target the other.
#include "two_pass.glsl"
#include <march>

uniform sampler2D t_points;   // first pass: exit points, or entry points when REVERSE; alpha 0 = no face there
uniform vec2 u_size;          // pixels of the target

in vec3 v_position;
out vec4 f_color;

void main() {
    vec2 ndc = gl_FragCoord.xy / u_size * 2.0 - 1.0;
    vec4 other = texelFetch(t_points, ivec2(gl_FragCoord.xy), 0);
#if REVERSE
    // no front face: the eye is inside, and the ray begins at the near plane
    Ray ray = ray_between(other.a > 0.5 ? other.xyz : unproject(vec3(ndc, -1.0)), v_position, ndc);
#else
    if (other.a < 0.5) discard;
    Ray ray = ray_between(v_position, other.xyz, ndc);
#endif
    if (!(ray.far > ray.near)) discard;
    f_color = march(ray, gl_FragCoord.xy);
}
