// The matter of several layers at a sample.

// Opaque matter lets so much through: its logarithm must be finite.
const float LEAST_TRANSPARENCY = 1e-30;

vec4 g_matter;

void add_matter(vec4 c, float share_per_unit_distance) {
    float depth = -log(max(1.0 - c.a, LEAST_TRANSPARENCY)) * share_per_unit_distance;
    g_matter += vec4(c.rgb * depth, depth);
}

// Sums of colour x extinction and of extinction, per world unit.
vec4 joint_matter() {
    g_matter = vec4(0.0);
    float left = seen_through_masks();
#pragma each_layer
#if MODE == 0
    add_matter(layer_color(samples[LAYER], samples[LAYER], AT_LATTICE), SHARE_OF_LATTICE * u_inverse_unit_distance);
#elif MODE == 2
    left *= layer_color(samples[LAYER], samples[LAYER], AT_LATTICE).a * SHARE_OF_LATTICE;
#endif
#pragma end
    return left * g_matter;
}
