// Hook <classify>: pre-integration (Engel, Kraus & Ertl 2001). Colour and opacity of a segment come from a table over
// the scalars at its two ends, made for a segment one unit distance long.
#pragma per_layer
#define CLASSIFY_SEGMENTS 1
#include "classification.glsl"
#include "gradient_opacity.glsl"

uniform sampler2D t_preintegrated;   // colour times opacity, opacity per unit distance; x = back, y = front
uniform vec2 u_preintegrated_map;    // texture coordinate = position in the table * x + y
uniform vec2 u_preintegrated_range;  // position in the table = fraction of the data range * x + y

vec4 classify(float front, float back, vec3 p, out vec3 gradient) {
    vec2 position = clamp(vec2(back, front) * u_preintegrated_range.x + u_preintegrated_range.y, 0.0, 1.0);
    vec4 c = textureLod(t_preintegrated, position * u_preintegrated_map.x + u_preintegrated_map.y, 0.0);
    c.rgb /= max(c.a, 1e-20);
    return with_gradient_opacity(c, p, gradient);
}
