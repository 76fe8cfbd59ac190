// Emission and absorption, front to back. With TABLE_PER_STEP the table holds opacities per step, and the unit
// distance is the step: full steps need no correction.
#define COMPOSITE_SKIPS 1

vec4 g_sum;

void composite_begin(float ray_length) { g_sum = vec4(0.0); }

bool composite_add(float front, float back, vec3 p, float segment_length, bool full_step) {
    vec4 c = layer_color(front, back, p);
#if TABLE_PER_STEP
    float a = full_step ? c.a : corrected_opacity(c.a, segment_length);
#else
    float a = corrected_opacity(c.a, segment_length);
#endif
    g_sum += (1.0 - g_sum.a) * vec4(c.rgb * a, a);
    return g_sum.a >= u_early_termination;
}

vec4 composite_end() { return g_sum; }
