// Hook <fetch>: stored values of eight bits, the eight around a place in one texel (gpu/corner_texels.py).
#pragma per_layer

uniform isampler3D t_scalars;
uniform vec3 u_texels;    // number of texels along each axis
uniform vec3 u_texel;     // size of one = 1 / u_texels

float fetch(vec3 p) {
    vec3 index = clamp(p * u_texels - 0.5, vec3(0.0), u_texels - 1.0);
    vec3 base = floor(index);
    vec3 f = index - base, g = 1.0 - f;
    ivec2 c = textureLod(t_scalars, (base + 0.5) * u_texel, 0.0).rg;
    vec4 w = vec4(g.x * g.y, f.x * g.y * 0.00390625, g.x * f.y * 1.52587890625e-5, f.x * f.y);
    float near = dot(w, vec4(c.x & 255, c.x & 65280, c.x & 16711680, (c.x >> 24) & 255));
    float far = dot(w, vec4(c.y & 255, c.y & 65280, c.y & 16711680, (c.y >> 24) & 255));
    return (near * g.z + far * f.z) * (1.0 / 255.0);
}
