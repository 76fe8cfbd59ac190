// From scalars to colour and opacity: the table of the transfer function and what becomes of its opacities.
#pragma per_layer

// The curve, straight, over the part of the range where it changes: a texel from each entry to the next
// (`segment_texels` in gpu/context.py). Curves of several layers stand in one texture, TABLE, this one in the rows from
// TABLE_ROW or TABLE_BASE on.
#ifndef TABLE
#define TABLE t_segments
#define TABLE_ROW 0.5
#define TABLE_BASE 0.0
uniform isampler2D t_segments;
#endif
uniform float u_table_segment;             // width of a segment = 1 / number of segments in a row
// 1 / 8191, 1 / (8191 * 2^13), 1 / 8191: green is left where it stands in its word.
const vec3 COLOR_STEPS = vec3(1.2208521548e-4, 1.4902980405e-8, 1.2208521548e-4);
uniform vec2 u_table_map;                  // position in the table, 0..1 = fraction of the data range * x + y
uniform float u_table_last;                // number of entries - 1
#if TABLE_FOLDED
uniform float u_table_row;                 // height of a row: the table goes on in the next one
#endif
uniform float u_density_threshold;         // fractions below it are left out
uniform float u_inverse_unit_distance;     // 1 / length to which opacities of the table belong, per world unit

// Straight RGBA of the curve over the value.
vec4 curve_color(float s) {
    float x = clamp(s * u_table_map.x + u_table_map.y, 0.0, 1.0) * u_table_last;
    float i = min(floor(x), u_table_last - 1.0);
    vec2 segment = vec2((i + 0.5) * u_table_segment, TABLE_ROW);
#if TABLE_FOLDED
    segment = vec2(fract(segment.x), (TABLE_BASE + floor(segment.x) + 0.5) * u_table_row);
#endif
    ivec4 ends = textureLod(TABLE, segment, 0.0);
    ivec2 blues = (ends.xy >> 26) & 63 | (ends.zw & 127) << 6;
    vec3 first = vec3(ends.x & 8191, ends.x & 67100672, blues.x);
    vec3 second = vec3(ends.y & 8191, ends.y & 67100672, blues.y);
    vec2 opacities = intBitsToFloat(ends.zw & ~127);
    vec4 c = vec4(mix(first, second, x - i) * COLOR_STEPS, mix(opacities.x, opacities.y, x - i));
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
