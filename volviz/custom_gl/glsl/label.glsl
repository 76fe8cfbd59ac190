// A layer of labels: to which label a point belongs, and where the ray crosses from one to another.
//
// The indicator of a label is 1 at its voxels, 0 elsewhere and linear between; a point belongs to the label whose
// indicator is the largest, between two labels where it is above one half. The normal of a surface is the gradient of
// the indicator, smoothed over NORMAL_RADIUS voxels by (1 - r^2)^2. Labels are dense indices, 0 is nothing. The
// place on the ray is that of the lattice: ON_LATTICE(t), IN_LATTICE(t).
#pragma per_layer
#include "lighting.glsl"

uniform usampler3D t_labels;
uniform sampler2D t_palette;          // colour and opacity of each label, 1024 to a row
uniform vec3 u_voxels;
uniform mat3 u_gradient_to_world;
uniform mat4 u_texture_to_centred;

const int BISECTIONS = 6;
const float NORMAL_RADIUS = 3.0;

uint g_label;      // where the segment begins
float g_border;    // length from there to where another label begins, 1e30 where none that is seen does
vec4 g_surface;    // straight colour of the surface there
uint g_owner;      // whose surface it is
vec3 g_border_gradient;   // along its normal, world

vec4 look_of(uint label) { return texelFetch(t_palette, ivec2(label & 1023u, label >> 10u), 0); }

uint label_of_voxel(ivec3 i) { return texelFetch(t_labels, clamp(i, ivec3(0), ivec3(u_voxels) - 1), 0).r; }

uint label_at(vec3 p) {
    vec3 index = p * u_voxels;
#if SMOOTH
    index -= 0.5;
    ivec3 first = ivec3(floor(index));
    vec3 part = index - vec3(first);
    uint labels[8];
    float weights[8];
    bool alike = true;
    for (int c = 0; c < 8; ++c) {
        ivec3 side = ivec3(c & 1, c >> 1 & 1, c >> 2 & 1);
        labels[c] = label_of_voxel(first + side);
        vec3 w = mix(1.0 - part, part, vec3(side));
        weights[c] = w.x * w.y * w.z;
        alike = alike && labels[c] == labels[0];
    }
    uint found = labels[0];
    if (!alike) {
        float most = -1.0;
        for (int c = 0; c < 8; ++c) {
            float share = 0.0;
            for (int other = 0; other < 8; ++other) share += labels[other] == labels[c] ? weights[other] : 0.0;
            if (share > most) { most = share; found = labels[c]; }
        }
    }
    return found;
#else
    return label_of_voxel(ivec3(floor(index)));
#endif
}

// Gradient of the smoothed indicator per voxel along the index axes, of any length.
vec3 indicator_gradient(vec3 p, uint label) {
    vec3 index = p * u_voxels - 0.5;
    ivec3 first = ivec3(floor(index));
    vec3 sum = vec3(0.0);
    const int EDGE = 2 * int(NORMAL_RADIUS);
    // one loop, that compilers leave rolled
    for (int n = 0; n < EDGE * EDGE * EDGE; ++n) {
        ivec3 voxel = first + ivec3(n % EDGE, n / EDGE % EDGE, n / (EDGE * EDGE)) + (1 - EDGE / 2);
        vec3 away = vec3(voxel) - index;
        float weight = 1.0 - dot(away, away) / (NORMAL_RADIUS * NORMAL_RADIUS);
        if (weight > 0.0 && label_of_voxel(voxel) == label) sum += weight * away;
    }
    return sum;
}

// Nothing is beyond the box.
uint label_on_ray(float t) { return IN_LATTICE(t) ? label_at(ON_LATTICE(t)) : 0u; }

// Look for a border in a segment, and take the label at its end for that where the next one begins. The surface is
// that of the label which the ray enters or, where that is hidden, of the one that it leaves.
void find_border(float begin, float segment_length) {
    g_border = 1e30;
    float low = begin, high = begin + segment_length;
    uint after = label_on_ray(high);
    if (after == g_label) return;
    vec4 look = look_of(after);
    bool entering = look.a > 0.0;
    uint owner = entering ? after : g_label;
    if (!entering) look = look_of(owner);
    if (look.a > 0.0) {
        for (int n = 0; n < BISECTIONS; ++n) {
            float middle = 0.5 * (low + high);
            uint there = label_on_ray(middle);
            if (entering ? there == after : there != owner) high = middle;
            else low = middle;
        }
        float t = 0.5 * (low + high);
        vec3 p = ON_LATTICE(t);
        vec3 gradient = u_gradient_to_world * indicator_gradient(p, owner);
        float size = length(gradient);
        if (size > 0.0) {
            look.rgb = lit_color(look.rgb, gradient / size, (u_texture_to_centred * vec4(p, 1.0)).xyz, 1.0);
        }
        g_border = t - begin;
        g_border_gradient = gradient;
        g_surface = look;
        g_owner = owner;
    }
    g_label = after;
}
