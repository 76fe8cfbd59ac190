// Hook <shade>: Blinn-Phong lighting. Ambient light is weakened by the hook <occlusion>, which must define
//     float occlusion(vec3 p, vec3 n)   the share 0..1 of ambient light that reaches a point (texture coordinates) of a
//                                       surface with the unit normal n (world, to either side); 1 = all of it
// It may include "sampling.glsl" and read what that declares.
#pragma per_layer
#include "lighting.glsl"
#include <occlusion>

uniform mat4 u_texture_to_centred;

vec3 shade(vec3 color, vec3 gradient, vec3 p) {
    float size = length(gradient);
    if (!(size > u_flat_gradient)) return color;
    vec3 n = gradient / size;
    return lit_color(color, n, (u_texture_to_centred * vec4(p, 1.0)).xyz, occlusion(p, n));
}
