// Blinn-Phong lighting (Blinn 1977), two-sided, in world space about the middle of the volume: far from the world's
// origin, 32-bit floats could not tell a voxel from the next.

uniform mat4 u_texture_to_place;
uniform vec3 u_eye_place;         // for parallel projection a point far behind the view
uniform vec3 u_light_place;
uniform vec3 u_light_color;
uniform float u_flat_gradient;    // gradients up to this are rounding, not surfaces
uniform vec4 u_material;          // ambient, diffuse, specular, shininess

// Colour of a surface with that world normal (any length; zero = unlit) at a place, world units from the middle.
vec3 lit_color(vec3 color, vec3 normal, vec3 place) {
    float size = length(normal);
    if (!(size > u_flat_gradient)) return color;
    vec3 n = normal / size;
    vec3 v = normalize(u_eye_place - place);
    vec3 l = normalize(u_light_place - place);
    vec3 sum = l + v;
    float half_length = length(sum);
    float n_dot_l = abs(dot(n, l));
    // light exactly behind: no half vector, no highlight
    float n_dot_h = half_length > 1e-6 ? abs(dot(n, sum / half_length)) : 0.0;
    vec3 lit = color * (u_material.x + u_material.y * n_dot_l * u_light_color);
    return lit + u_material.z * pow(n_dot_h, u_material.w) * u_light_color;
}

vec3 lit_at_texture_point(vec3 color, vec3 normal, vec3 p) {
    return lit_color(color, normal, (u_texture_to_place * vec4(p, 1.0)).xyz);
}
