// Hook <classify>: the curve over the value.
#pragma per_layer
#define CLASSIFY_SEGMENTS 0
#include "classification.glsl"
#include "gradient_opacity.glsl"

vec4 classify(float front, float back, vec3 p, out vec3 gradient) {
    return with_gradient_opacity(curve_color(front), p, gradient);
}
