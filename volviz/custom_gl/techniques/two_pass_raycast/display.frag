// Machinery view: what the first pass holds, as opaque colour.
#include "rays.glsl"

uniform sampler2D t_points;
uniform bool u_inside;   // pixels without an entry point show the near plane, where their rays begin

in vec2 v_ndc;
out vec4 f_color;

void main() {
    vec4 point = texelFetch(t_points, ivec2(gl_FragCoord.xy), 0);
    if (point.a < 0.5) {
        if (!u_inside) discard;
        point = vec4(unproject(vec3(v_ndc, -1.0)), 1.0);
    }
    f_color = clamp(point, 0.0, 1.0);
}
