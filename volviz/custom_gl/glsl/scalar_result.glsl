// Colour of a ray whose result is one scalar: classified once, premultiplied.
#pragma per_layer
#include "classification.glsl"

vec4 classified_result(float s) {
    vec4 c = curve_color(s);
    return vec4(c.rgb * c.a, c.a);
}
