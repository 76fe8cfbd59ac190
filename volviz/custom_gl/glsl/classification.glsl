// From scalars to colour and opacity: the table of the transfer function and what becomes of its opacities.
#pragma per_layer

uniform sampler2D t_table;                 // straight RGBA over the part of the range where it changes, one row
uniform vec2 u_table_map;                  // position in the table, 0..1 = fraction of the data range * x + y
uniform float u_table_last;                // number of entries - 1
uniform float u_table_entry;               // width of an entry = 1 / number of entries in a row
#if TABLE_FOLDED
uniform float u_table_row;                 // height of a row: the table goes on in the next one
#endif
uniform float u_density_threshold;         // fractions below it are left out
uniform float u_inverse_unit_distance;     // 1 / length to which opacities of the table belong, per world unit

// Where the table lies: in a texture of its own, or in one with those of other layers.
#ifndef TABLE
#define TABLE t_table
#define TABLE_ROW 0.5
#define TABLE_BASE 0.0
#endif

#if TABLE_FOLDED
// An entry of a table that takes several rows, from 0.
vec4 table_entry(float i) {
    float position = (i + 0.5) * u_table_entry;
    return textureLod(TABLE, vec2(fract(position), (TABLE_BASE + floor(position) + 0.5) * u_table_row), 0.0);
}
#endif

// Straight RGBA of the curve over the value.
vec4 curve_color(float s) {
    // two fetches and a mix: a linear filter reads four texels of a texture that is one texel high
    float x = clamp(s * u_table_map.x + u_table_map.y, 0.0, 1.0) * u_table_last;
    float i = min(floor(x), u_table_last - 1.0);
#if TABLE_FOLDED
    vec4 c = mix(table_entry(i), table_entry(i + 1.0), x - i);
#else
    vec2 entry = vec2((i + 0.5) * u_table_entry, TABLE_ROW);
    vec4 c = mix(textureLod(TABLE, entry, 0.0), textureLod(TABLE, entry + vec2(u_table_entry, 0.0), 0.0), x - i);
#endif
    return s < u_density_threshold ? vec4(0.0) : c;
}

// Opacity of a segment of that world length: a' = 1 - (1 - a)^(length / unit distance).
float corrected_opacity(float a, float segment_length) {
    return 1.0 - pow(max(1.0 - a, 0.0), segment_length * u_inverse_unit_distance);
}

// Extinction per world unit that belongs to an opacity per unit distance.
float extinction(float a) {
    return -log(max(1.0 - a, 1e-7)) * u_inverse_unit_distance;
}
