// From what the slices left in the accumulation target to colour.
#include "scalar_result.glsl"

uniform sampler2D t_accumulated;
out vec4 f_color;

void main() {
    vec4 sum = texelFetch(t_accumulated, ivec2(gl_FragCoord.xy), 0);
#if RESOLVE_ADDITIVE
    f_color = clamp(sum, 0.0, 1.0);
#elif RESOLVE_AVERAGE
    if (sum.a <= 0.0) discard;
    f_color = classified_result(sum.r / sum.a);
#else
    // outside 0..1 no slice has drawn anything
    if (sum.r < -0.5 || sum.r > 1.5) discard;
    f_color = classified_result(sum.r);
#endif
}
