// A classified sample with gradient opacity and lighting as far as they are switched on: straight RGBA.
vec4 shaded_sample(float s, vec3 p) {
#if BY_GRADIENT
    if (!may_be_visible(s)) return vec4(0.0);
    vec3 gradient = world_gradient(p);
    vec4 c = classify(s, length(gradient));
#else
    vec4 c = classify(s);
#endif
#if SHADING || GRADIENT_OPACITY
    if (c.a > 0.0) {
#if !BY_GRADIENT
        vec3 gradient = world_gradient(p);
#endif
#if GRADIENT_OPACITY
        c.a *= gradient_factor(gradient);
#endif
#if SHADING
        c.rgb = lit_at_texture_point(c.rgb, gradient, p);
#endif
    }
#endif
    return c;
}
