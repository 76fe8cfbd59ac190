// One pass of a separable Gaussian over premultiplied splats, with the nearest depth in its reach.
uniform sampler2D t_splats;
uniform sampler2D t_splat_depth;
uniform ivec2 u_axis;
uniform int u_taps;           // to either side
uniform float u_falloff;      // 1 / (2 sigma^2)
#if SCENE_DEPTH
uniform sampler2D t_scene_depth;
uniform vec2 u_size;
#endif
out vec4 f_color;

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    ivec2 size = textureSize(t_splats, 0);
    vec4 sum = vec4(0.0);
    float total = 0.0;
    float nearest = 1.0;
    for (int i = -u_taps; i <= u_taps; ++i) {
        ivec2 position = here + i * u_axis;
        ivec2 inside = clamp(position, ivec2(0), size - 1);
        // beyond the window nothing is known: its share goes to the rest
        float weight = inside == position ? exp(-u_falloff * float(i * i)) : 0.0;
        sum += weight * texelFetch(t_splats, inside, 0);
        total += weight;
        nearest = min(nearest, texelFetch(t_splat_depth, inside, 0).r);
    }
    f_color = sum / total;
    if (f_color.a <= 0.0) discard;
#if FINAL
#if SCENE_DEPTH
    if (textureLod(t_scene_depth, gl_FragCoord.xy / u_size, 0.0).r < nearest) discard;
#endif
    // the faint outer half of the edge is no surface
    gl_FragDepth = f_color.a >= 0.5 ? nearest : 1.0;
#else
    gl_FragDepth = nearest;
#endif
}
