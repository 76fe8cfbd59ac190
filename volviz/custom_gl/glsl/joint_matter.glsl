// The matter of several layers at a sample.

// Opaque matter lets so much through: its logarithm must be finite.
const float LEAST_TRANSPARENCY = 1e-30;

vec4 g_matter;
vec3 g_unlit;    // sum of colour x extinction before lighting

// Optical depth of an opacity, both per unit distance.
float optical_depth(float a) { return -log(max(1.0 - a, LEAST_TRANSPARENCY)); }

// DEPTHS of a layer is 1 where its table holds optical depths in the place of opacities, which saves a logarithm.
// Sums of lit colour x extinction and of extinction, per world unit.
vec4 joint_matter() {
    g_matter = vec4(0.0);
    g_unlit = vec3(0.0);
    float left = seen_through_masks();
#pragma each_layer
#if MODE == 0
    {
    vec3 gradient;
    vec4 c = classify(samples[LAYER], samples[LAYER], AT_LATTICE, gradient);
#if DEPTHS
    float depth = c.a * SHARE_OF_LATTICE * u_inverse_unit_distance;
#else
    float depth = optical_depth(c.a) * SHARE_OF_LATTICE * u_inverse_unit_distance;
#endif
    g_unlit += c.rgb * depth;
    if (c.a > 0.0) c.rgb = shade(c.rgb, gradient, AT_LATTICE);
    g_matter += vec4(c.rgb * depth, depth);
    }
#elif MODE == 2
    left *= layer_color(samples[LAYER], samples[LAYER], AT_LATTICE).a * SHARE_OF_LATTICE;
#endif
#pragma end
    g_unlit *= left;
    return left * g_matter;
}
