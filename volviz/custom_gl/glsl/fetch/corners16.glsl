// Hook <fetch>: stored values of sixteen bits, the eight around a place in one texel (gpu/corner_texels.py).
#pragma per_layer

uniform isampler3D t_scalars;
uniform vec3 u_texels;    // number of texels along each axis
uniform vec3 u_texel;     // size of one = 1 / u_texels

float fetch(vec3 p) {
    vec3 index = clamp(p * u_texels - 0.5, vec3(0.0), u_texels - 1.0);
    vec3 base = floor(index);
    vec3 f = index - base;
    ivec4 c = textureLod(t_scalars, (base + 0.5) * u_texel, 0.0);
    vec4 near = vec4(c.x & 65535, (c.x >> 16) & 65535, c.y & 65535, (c.y >> 16) & 65535);
    vec4 far = vec4(c.z & 65535, (c.z >> 16) & 65535, c.w & 65535, (c.w >> 16) & 65535);
    vec4 plane = mix(near, far, f.z);
    vec2 row = mix(plane.xy, plane.zw, f.y);
    return mix(row.x, row.y, f.x) * (1.0 / 65535.0);
}
