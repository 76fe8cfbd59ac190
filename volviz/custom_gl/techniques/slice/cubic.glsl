// The cubic B-spline through the voxels (Unser 1999): a sum over 4 x 4 x 4 coefficients, mirrored at the borders.
uniform sampler3D t_coefficients;    // in the unit of the store, as `fetch`

// Weights of the four coefficients around a point, f = its distance beyond the second one, 0..1.
vec4 spline_weights(float f) {
    float g = 1.0 - f;
    vec2 outer = vec2(g * g * g, f * f * f) / 6.0;
    vec2 inner = vec2(4.0 - 3.0 * f * f * (2.0 - f), 4.0 - 3.0 * g * g * (2.0 - g)) / 6.0;
    return vec4(outer.x, inner, outer.y);
}

ivec3 mirrored(ivec3 i, ivec3 last) { return last - abs(last - abs(i)); }

float cubic_scalar(vec3 p) {
    vec3 index = p * u_voxels - 0.5;
    vec3 base = floor(index);
    vec3 f = index - base;
    vec4 wx = spline_weights(f.x), wy = spline_weights(f.y), wz = spline_weights(f.z);
    ivec3 last = textureSize(t_coefficients, 0) - 1;
    ivec3 first = ivec3(base) - 1;
    float sum = 0.0;
    for (int k = 0; k < 4; ++k) {
        for (int j = 0; j < 4; ++j) {
            float row = 0.0;
            for (int i = 0; i < 4; ++i) {
                row += wx[i] * texelFetch(t_coefficients, mirrored(first + ivec3(i, j, k), last), 0).r;
            }
            sum += wz[k] * wy[j] * row;
        }
    }
    return sum * u_scalar_map.x + u_scalar_map.y;
}
