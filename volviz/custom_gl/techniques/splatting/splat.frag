// The footprint of a splat: an opaque disc, or a Gaussian.
flat in vec4 v_color;
flat in float v_pixels;
#if QUADS
in vec2 v_position;
#endif
out vec4 f_color;

#if GAUSSIAN
#if SCENE_DEPTH
uniform sampler2D t_scene_depth;
uniform vec2 u_size;
#endif
// The footprint is cut off at so many standard deviations.
const float REACH = 2.5;
#endif

void main() {
#if QUADS
    vec2 position = v_position;
#else
    vec2 position = gl_PointCoord * 2.0 - 1.0;
#endif
    float radius = length(position);
#if GAUSSIAN
#if SCENE_DEPTH
    if (textureLod(t_scene_depth, gl_FragCoord.xy / u_size, 0.0).r < gl_FragCoord.z) discard;
#endif
    if (radius > 1.0) discard;
    float a = 1.0 - exp(-v_color.a * exp(-0.5 * REACH * REACH * radius * radius));
    f_color = vec4(v_color.rgb * a, a);
#else
    // of a splat no larger than a pixel something must remain
    if (radius * v_pixels > max(v_pixels, 1.5)) discard;
    f_color = v_color;
#endif
}
