// Hook <classify>: regions over value and gradient magnitude. t_table holds colour times opacity and opacity, with
// rows over the gradient, and covers the part of the plane in which the regions lie.
#pragma per_layer
#define CLASSIFY_SEGMENTS 0
#include "classification.glsl"
#include "gradient_opacity.glsl"

uniform sampler2D t_table;
uniform vec2 u_plane_map;      // row, 0..1 = gradient in fractions of the range per world unit * x + y
uniform vec4 u_plane_texels;   // texture coordinates = (column, row) * xy + zw

// Whether any gradient could make the value visible: regions end within the table.
bool may_be_visible(float s) {
    return abs(s * u_table_map.x + u_table_map.y - 0.5) <= 0.5 && s >= u_density_threshold;
}

vec4 classify(float front, float back, vec3 p, out vec3 gradient) {
    gradient = vec3(0.0);
    if (!may_be_visible(front)) return vec4(0.0);
    gradient = world_gradient(p);
    vec2 entry = vec2(front * u_table_map.x + u_table_map.y, length(gradient) * u_plane_map.x + u_plane_map.y);
    vec4 c = textureLod(t_table, clamp(entry, 0.0, 1.0) * u_plane_texels.xy + u_plane_texels.zw, 0.0);
    c.rgb /= max(c.a, 1e-20);
    c.a *= gradient_factor(gradient);
    return c;
}
