// Emission and absorption with pre-integrated classification (Engel, Kraus & Ertl 2001): colour and opacity of a
// segment come from a table over the scalars at its two ends, made for a segment one unit distance long.
#define MODE_SKIPS 1
#define MODE_SEGMENTS 1

uniform sampler2D t_preintegrated;   // colour times opacity, opacity per unit distance; x = back, y = front
uniform vec2 u_preintegrated_map;    // texture coordinate = position in the table * x + y
uniform vec2 u_preintegrated_range;  // position in the table = fraction of the data range * x + y

vec4 g_sum;

void mode_begin(float total) { g_sum = vec4(0.0); }

bool mode_add(float front, float back, vec3 p, float length_of_segment, bool whole) {
    vec2 position = clamp(vec2(back, front) * u_preintegrated_range.x + u_preintegrated_range.y, 0.0, 1.0);
    vec4 c = textureLod(t_preintegrated, position * u_preintegrated_map.x + u_preintegrated_map.y, 0.0);
    c.rgb /= max(c.a, 1e-20);
#if SHADING || GRADIENT_OPACITY
    if (c.a > 0.0) {
        vec3 gradient = world_gradient(p);
#if GRADIENT_OPACITY
        c.a *= gradient_factor(gradient);
#endif
#if SHADING
        c.rgb = lit_at_texture_point(c.rgb, gradient, p);
#endif
    }
#endif
    float a = corrected_opacity(c.a, length_of_segment);
    g_sum += (1.0 - g_sum.a) * vec4(c.rgb * a, a);
    return g_sum.a >= u_early_termination;
}

vec4 mode_end() { return g_sum; }
