// Emission only: the sum of colour x extinction x length, independent of the step.
#define COMPOSITE_SKIPS 1

vec4 g_sum;

void composite_begin(float ray_length) { g_sum = vec4(0.0); }

bool composite_add(float front, float back, vec3 p, float segment_length, bool full_step) {
    vec4 c = layer_color(front, back, p);
    float depth = extinction(c.a) * segment_length;
    g_sum += vec4(c.rgb * depth, depth);
    return false;
}

vec4 composite_end() { return clamp(g_sum, 0.0, 1.0); }
