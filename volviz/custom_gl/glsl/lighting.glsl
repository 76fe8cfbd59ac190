// Blinn-Phong lighting (Blinn 1977), two-sided, in centred coordinates: world axes and units from the middle of the
// volume. Far from the world's origin, 32-bit floats could not tell a voxel from the next.
#pragma per_layer

uniform vec3 u_eye_centred;       // for parallel projection a point far behind the view
uniform vec3 u_light_centred;
uniform vec3 u_light_color;
uniform float u_flat_gradient;    // gradients up to this are rounding, not surfaces
uniform vec4 u_material;          // ambient, diffuse, specular, shininess

// Colour of a surface with that unit normal (world) at a point in centred coordinates; `ambient` is the share of
// ambient light that reaches it.
vec3 lit_color(vec3 color, vec3 n, vec3 centred, float ambient) {
    vec3 v = normalize(u_eye_centred - centred);
    vec3 l = normalize(u_light_centred - centred);
    vec3 sum = l + v;
    float half_length = length(sum);
    float n_dot_l = abs(dot(n, l));
    // light exactly behind: no half vector, no highlight
    float n_dot_h = half_length > 1e-6 ? abs(dot(n, sum / half_length)) : 0.0;
    vec3 lit = color * (ambient * u_material.x + u_material.y * n_dot_l * u_light_color);
    return lit + u_material.z * pow(n_dot_h, u_material.w) * u_light_color;
}
