// What one volume contributes at a point or in a segment of a ray: its scalar, and the colour that is seen of it.
//
// Hooks, with points p in texture coordinates of this volume, scalars in fractions 0..1 of its data range and gradients in
// fractions of the range per world unit:
//     <fetch>      see sampling.glsl
//     <classify>   must define
//                      CLASSIFY_SEGMENTS   1 when it wants the scalars at both ends of a segment, 0 when `front` and
//                                          `back` are the one sample that stands for it
//                      vec4 classify(float front, float back, vec3 p, out vec3 gradient)   straight RGBA; opacity for
//                                          one unit distance (TABLE_PER_STEP: for one step); gradient in the world
//                                          at p, zero where nothing is visible
//                  may read whatever sampling.glsl and classification.glsl declare
//     <shade>      must define
//                      vec3 shade(vec3 color, vec3 gradient, vec3 p)   straight RGB as the eye sees it; the gradient is
//                                          any vector along the normal, too short where there is no surface
//                  may read whatever sampling.glsl and lighting.glsl declare
// Included as LAYER1 once more, it defines sample_scalar_1 and layer_color_1: a second volume in the same loop.
#pragma per_layer
#include "sampling.glsl"
#include <classify>
#include <shade>

// Straight RGBA of a segment or of the sample that stands for it, as `classify` takes them.
vec4 layer_color(float front, float back, vec3 p) {
    vec3 gradient;
    vec4 c = classify(front, back, p, gradient);
    if (c.a > 0.0) c.rgb = shade(c.rgb, gradient, p);
    return c;
}
