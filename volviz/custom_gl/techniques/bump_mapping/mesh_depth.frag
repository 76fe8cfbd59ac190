// The mesh's depth alone, so that afterwards only what is seen is lit.
#include "shown_part.glsl"

in vec3 v_texture;
out vec4 f_color;

void main() {
    if (!is_shown(v_texture)) discard;
    f_color = vec4(0.0);
}
