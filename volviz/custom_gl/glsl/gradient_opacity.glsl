// Opacity that is taken away where the data hardly changes.
#pragma per_layer
#include "sampling.glsl"

#if GRADIENT_OPACITY
uniform float u_gradient_opacity;          // 0..1
uniform float u_inverse_gradient_scale;    // 1 / largest gradient, in world units per fraction of the range
#endif

// Factor on opacity from the gradient in the world (fractions of the range per world unit); 1 when switched off.
float gradient_factor(vec3 gradient) {
#if GRADIENT_OPACITY
    return mix(1.0, min(length(gradient) * u_inverse_gradient_scale, 1.0), u_gradient_opacity);
#else
    return 1.0;
#endif
}

// A classified colour with its opacity reduced, and the gradient, which is looked up where something is visible only.
vec4 with_gradient_opacity(vec4 c, vec3 p, out vec3 gradient) {
    gradient = vec3(0.0);
    if (c.a > 0.0) {
        gradient = world_gradient(p);
        c.a *= gradient_factor(gradient);
    }
    return c;
}
