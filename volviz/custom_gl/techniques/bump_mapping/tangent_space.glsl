// Normals and light vectors in tangent space, and their dot product: I = max(dot(n, l), 0).
//
// ENCODING 0 computes with floating-point vectors. 1 and 2 keep both vectors as 8-bit colours, c = 0.5 + 0.5 v or
// 128 + 127 v, and take the product of the colours as texture combiners did: DOT3 = 4 sum (n_c - 0.5)(l_c - 0.5).
#include "sampling.glsl"

uniform sampler2D t_normal_map;      // unit vectors, periodic
uniform samplerCube t_normalization; // a vector's direction: as colour when ENCODING, else as it is
uniform float u_flat_gradient;
uniform float u_bump_strength;
uniform float u_relief_height;       // world units that the whole range of the data is high
uniform float u_green;               // -1 when the map's green points down

#if MESH && !MESH_FILE
uniform mat4 u_world_to_texture;
uniform float u_mesh_fraction;       // the isovalue as fraction of the data range
uniform float u_mesh_reach;          // world units that triangles may lie off the surface
#endif

vec3 encoded(vec3 v) {
#if ENCODING == 2
    return floor(128.0 + 127.0 * v + 0.5) / 255.0;
#else
    return floor(255.0 * (0.5 + 0.5 * v) + 0.5) / 255.0;
#endif
}

vec3 decoded(vec3 c) {
#if ENCODING == 2
    return (c * 255.0 - 128.0) / 127.0;
#else
    return 2.0 * (c - 0.5);
#endif
}

// A vector as it is shown: the colour that holds it.
vec3 vector_color(vec3 v) {
#if ENCODING
    return encoded(v);
#else
    return 0.5 + 0.5 * v;
#endif
}

#if MESH && !MESH_FILE
// The point of the isosurface that lies nearest along the triangle's normal, as when normal maps are baked; false when
// there is none within reach.
bool on_surface(inout vec3 p, vec3 n) {
    const int STEPS = 8;
    vec3 way = (u_world_to_texture * vec4(n * (2.0 * u_mesh_reach / float(STEPS)), 0.0)).xyz;
    vec3 start = p - 0.5 * float(STEPS) * way;
    float nearest = 1e9;
    float below = sample_scalar(start) - u_mesh_fraction;
    for (int k = 1; k <= STEPS; ++k) {
        float above = sample_scalar(start + float(k) * way) - u_mesh_fraction;
        if (below >= 0.0 && above < 0.0) {
            float t = float(k - 1) + below / (below - above);
            if (abs(t - 0.5 * float(STEPS)) < abs(nearest - 0.5 * float(STEPS))) nearest = t;
        }
        below = above;
    }
    if (nearest > 1e8) return false;
    p = start + nearest * way;
    return true;
}
#endif

// The normal of the relief in tangent space, unit length.
vec3 tangent_normal(vec3 p, vec2 uv, vec3 t, vec3 b, vec3 n, float facing) {
#if SOURCE_DATA && MESH && !MESH_FILE
    // the surface's own normal, taken where the surface is: beside the coarse triangle
    n = normalize(n);
    bool found = on_surface(p, n);
    vec3 g = -world_gradient(p);
    float size = length(g);
    // a surface that stands across the triangle is another one
    found = found && size > u_flat_gradient && dot(g, n) > 0.3 * size;
    vec3 v = vec3(0.0, 0.0, 1.0);
    if (found) v = vec3(u_bump_strength * vec2(dot(g, t), dot(g, b)), dot(g, n)) / size;
#elif SOURCE_DATA
    vec3 g = world_gradient(p);
    vec3 v = vec3(-u_relief_height * vec2(dot(g, t), dot(g, b)), 1.0);
#else
#if VERTEX_STAGE
    vec3 v = textureLod(t_normal_map, uv, 0.0).xyz;
#else
    vec3 v = texture(t_normal_map, uv).xyz;
#endif
    v = vec3(u_bump_strength * v.x, u_bump_strength * u_green * v.y, max(v.z, 1e-3));
#endif
    v = normalize(v);
#if MESH
    // the inner side of an open mesh
    return facing < 0.0 ? -v : v;
#else
    return v;
#endif
}

vec3 looked_up(vec3 l) {
    vec3 c = textureLod(t_normalization, l, 0.0).rgb;
#if ENCODING
    // what a texture unit hands on has 8 bits, too
    return decoded(floor(c * 255.0 + 0.5) / 255.0);
#else
    return c;
#endif
}

// Direction of the light: the only place where interpolated vectors get their length back.
vec3 light_direction(vec3 l) {
#if CUBE_MAP
    return looked_up(l);
#elif ENCODING
    return decoded(encoded(normalize(l)));
#else
    return normalize(l);
#endif
}

float intensity(vec3 n, vec3 l) {
    vec3 direction = light_direction(l);
#if ENCODING == 0
    float product = dot(n, direction);
#else
    float product = dot(decoded(encoded(n)), direction);   // = 4 sum (n_c - 0.5)(l_c - 0.5)
#endif
    product = clamp(product, 0.0, 1.0);
#if SELF_SHADOWING
    product *= clamp(8.0 * direction.z, 0.0, 1.0);   // Kilgard 2000
#endif
    return product;
}
