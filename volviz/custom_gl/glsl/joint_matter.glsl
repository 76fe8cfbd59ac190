// The matter of several layers at a sample.

// Opaque matter lets so much through: its logarithm must be finite.
const float LEAST_TRANSPARENCY = 1e-30;

vec4 g_matter;

// Optical depth of an opacity, both per unit distance.
float optical_depth(float a) { return -log(max(1.0 - a, LEAST_TRANSPARENCY)); }

void add_matter(vec4 c, float depth) {
    g_matter += vec4(c.rgb * depth, depth);
}

// DEPTHS of a layer is 1 where its table holds optical depths in the place of opacities, which saves a logarithm.
// Sums of colour x extinction and of extinction, per world unit.
vec4 joint_matter() {
    g_matter = vec4(0.0);
    float left = seen_through_masks();
#pragma each_layer
#if MODE == 0
    {
    vec4 c = layer_color(samples[LAYER], samples[LAYER], AT_LATTICE);
#if DEPTHS
    add_matter(c, c.a * SHARE_OF_LATTICE * u_inverse_unit_distance);
#else
    add_matter(c, optical_depth(c.a) * SHARE_OF_LATTICE * u_inverse_unit_distance);
#endif
    }
#elif MODE == 2
    left *= layer_color(samples[LAYER], samples[LAYER], AT_LATTICE).a * SHARE_OF_LATTICE;
#endif
#pragma end
    return left * g_matter;
}
