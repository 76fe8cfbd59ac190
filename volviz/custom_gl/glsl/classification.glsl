// From scalars to colour and opacity.

uniform sampler2D t_table;                 // straight RGBA over the part of the range where it changes, one row;
                                           // BY_GRADIENT: colour times opacity and opacity, rows over the gradient
uniform vec2 u_table_map;                  // position in the table, 0..1 = fraction of the data range * x + y
uniform float u_table_last;                // number of entries - 1
uniform float u_table_entry;               // width of an entry = 1 / number of entries
uniform float u_density_threshold;         // fractions below it are left out
uniform float u_inverse_unit_distance;     // 1 / opacity unit distance, per world unit
uniform float u_gradient_opacity;          // 0..1
uniform float u_inverse_gradient_scale;    // 1 / largest gradient, in world units per fraction of the range

vec4 classify(float s) {
    // two fetches and a mix: a linear filter reads four texels of a texture that is one texel high
    float x = clamp(s * u_table_map.x + u_table_map.y, 0.0, 1.0) * u_table_last;
    float i = min(floor(x), u_table_last - 1.0);
    vec2 place = vec2((i + 0.5) * u_table_entry, 0.5);
    vec4 c = mix(textureLod(t_table, place, 0.0), textureLod(t_table, place + vec2(u_table_entry, 0.0), 0.0), x - i);
    return s < u_density_threshold ? vec4(0.0) : c;
}

#if BY_GRADIENT
uniform vec2 u_plane_map;                  // row, 0..1 = gradient in fractions of the range per world unit * x + y
uniform vec4 u_plane_texels;               // texture coordinates = (column, row) * xy + zw

// Whether any gradient could make the value visible: regions end within the table.
bool may_be_visible(float s) {
    return abs(s * u_table_map.x + u_table_map.y - 0.5) <= 0.5 && s >= u_density_threshold;
}

// Straight RGBA of a value that may be visible and the length of its gradient.
vec4 classify(float s, float gradient) {
    vec2 place = clamp(vec2(s * u_table_map.x + u_table_map.y, gradient * u_plane_map.x + u_plane_map.y), 0.0, 1.0);
    vec4 c = textureLod(t_table, place * u_plane_texels.xy + u_plane_texels.zw, 0.0);
    c.rgb /= max(c.a, 1e-20);
    return c;
}
#endif

// Opacity of a piece of ray of that world length: a' = 1 - (1 - a)^(length / unit distance).
float corrected_opacity(float a, float world_length_of_sample) {
    return 1.0 - pow(max(1.0 - a, 0.0), world_length_of_sample * u_inverse_unit_distance);
}

// Extinction per world unit that belongs to an opacity per unit distance.
float extinction(float a) {
    return -log(max(1.0 - a, 1e-7)) * u_inverse_unit_distance;
}

// Factor on opacity from the gradient in the world (fractions of the range per world unit).
float gradient_factor(vec3 gradient) {
    return mix(1.0, min(length(gradient) * u_inverse_gradient_scale, 1.0), u_gradient_opacity);
}
