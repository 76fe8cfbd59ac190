// From what the slices left in the accumulation target to colour, for the layer with the number DRAWN.
#if LAYERS
uniform isampler2D t_layer_tables;
#endif
#pragma each_layer
#if LAYER == DRAWN
#include "scalar_result.glsl"
vec4 result_of(float s) { return classified_result(s); }
#endif
#pragma end

uniform sampler2D t_accumulated;
out vec4 f_color;

void main() {
    vec4 sum = texelFetch(t_accumulated, ivec2(gl_FragCoord.xy), 0);
#if RESOLVE_ADDITIVE
    f_color = clamp(sum, 0.0, 1.0);
#elif RESOLVE_AVERAGE
    if (sum.a <= 0.0) discard;
    f_color = result_of(sum.r / sum.a);
#else
    // outside 0..1 no slice has drawn anything
    if (sum.r < -0.5 || sum.r > 1.5) discard;
    f_color = result_of(sum.r);
#endif
}
