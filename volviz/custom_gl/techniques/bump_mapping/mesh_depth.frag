// The mesh's depth alone, so that afterwards only what is seen is lit.
#include "clipping.glsl"

in vec3 v_texture;
out vec4 f_color;

void main() {
    if (is_cropped(v_texture) || is_clipped(v_texture)) discard;
    f_color = vec4(0.0);
}
