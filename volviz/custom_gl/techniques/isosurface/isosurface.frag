// Isosurfaces along one ray: crossings between consecutive samples, in both directions, refined by bisection.
//
// A point is inside the surface of an isovalue when its scalar is at least that value. The *level* of a sample is the
// number of isovalues it is inside of; a change of level between two samples means crossings of the isovalues between.
#include "rays.glsl"
#include "sampling.glsl"
#include "shade/lit.glsl"
#include "empty_space.glsl"

uniform float u_step;                // world units
uniform int u_bisections;
uniform vec4 u_isovalues;            // fractions of the data range, ascending; unused ones larger than any scalar
uniform vec4 u_surface_colors[4];    // straight RGB and opacity

in vec2 v_ndc;
out vec4 f_color;

// Accumulated opacity from which a ray ends, and from which on its depth is known.
const float OPAQUE = 0.999;
const float SEEN = 0.5;

int level_of(float s) {
#if SURFACES == 1
    return s >= u_isovalues.x ? 1 : 0;
#else
    return int(dot(vec4(greaterThanEqual(vec4(s), u_isovalues)), vec4(1.0)) + 0.5);
#endif
}

// World length along the ray, between two samples `near` and `far` on different sides of an isovalue, at which it is
// reached. `a` and `b` are the samples' scalars; halving keeps one end on each side, then the line between them counts.
float crossing(vec3 entry, vec3 direction, float near, float far, float a, float b, float isovalue) {
    bool from_inside = a >= isovalue;
    for (int i = 0; i < u_bisections; ++i) {
        float middle = 0.5 * (near + far);
        float s = sample_scalar(entry + middle * direction);
        bool before = (s >= isovalue) == from_inside;
        near = before ? middle : near;
        a = before ? s : a;
        far = before ? far : middle;
        b = before ? b : s;
    }
    return near + (far - near) * clamp((isovalue - a) / (b - a), 0.0, 1.0);
}

void main() {
    Ray ray = make_ray(v_ndc);
    if (!(ray.far > ray.near)) discard;
    float total = ray.far - ray.near;
    float inverse_step = 1.0 / u_step;
    // samples 0..last; the last segment is shorter, and below a thousandth of a step it is rounding
    int last = max(int(ceil(total * inverse_step - 1e-3)), 1);
    vec3 entry = ray.origin + ray.near * ray.direction;
    vec3 inverse_direction = inverse_in_bricks(ray.direction);
    vec4 sum = vec4(0.0);
    float depth = 1.0;
    vec3 point = vec3(0.0), normal = vec3(0.0);   // of the nearest surface
    float samples = 0.0;
    int k = 0;             // sample at the front end of the present segment
    int run_end = 0;       // samples before this one lie in bricks that a surface may cross
    int level = -1;        // of the point reached so far; -1 = to be sampled at k
    float front = 0.0, back = 0.0;
    bool open = true;      // the ray goes on
    // Each turn finds one crossing. Refinement and lighting lie outside the loops over samples, so that rays that are
    // drawn side by side do them together.
    while (open) {
        bool crossed = false;
        int back_level = level;
        while (k < last && !crossed) {
            // on to the next bricks that may be crossed
            int found = k;
            bool search = k >= run_end;
            while (search && found <= last) {
                Brick b = brick_at(entry + min(float(found) * u_step, total) * ray.direction);
                int clear = int(clear_length(b, inverse_direction) * inverse_step);
                search = !b.visible;
                if (search) {
                    found += max(clear, 1);
                    // a segment with one end in such a brick counts: begin one sample earlier
                    k = min(found - 1, last);
                    level = -1;
                } else {
                    run_end = found + 1 + clear;
                }
            }
            if (level < 0) {
                front = sample_scalar(entry + min(float(k) * u_step, total) * ray.direction);
                level = level_of(front);
            }
            int stop = search ? last : min(run_end, last);
            while (k < stop) {
                back = sample_scalar(entry + min(float(k + 1) * u_step, total) * ray.direction);
                back_level = level_of(back);
                samples += 1.0;
                if (back_level != level) { crossed = true; break; }
                front = back;
                ++k;
            }
        }
        if (!crossed) break;
        bool rising = back_level > level;
        int surface = rising ? level : level - 1;
        float near = float(k) * u_step;
        float t = crossing(entry, ray.direction, near, min(near + u_step, total), front, back, u_isovalues[surface]);
        vec3 p = entry + t * ray.direction;
        vec3 gradient = world_gradient(p);
        vec4 look = u_surface_colors[surface];
        vec3 lit = shade(look.rgb, gradient, p);
        if (depth == 1.0 && sum.a + (1.0 - sum.a) * look.a >= SEEN) depth = window_depth(p);
        if (sum.a == 0.0) { point = p; normal = -gradient; }
        sum += (1.0 - sum.a) * look.a * vec4(lit, 1.0);
        open = sum.a < OPAQUE;
        level += rising ? 1 : -1;
        if (level == back_level) { front = back; ++k; }
    }
    gl_FragDepth = depth;
#if DISPLAY_SAMPLES
    f_color = vec4(vec3(samples / 255.0), 1.0);
#else
    if (sum.a == 0.0) discard;
#if DISPLAY_POSITIONS
    f_color = vec4(point, 1.0);
#elif DISPLAY_NORMALS
    f_color = vec4(0.5 + 0.5 * normal / max(length(normal), 1e-30), 1.0);
#else
    f_color = sum;
#endif
#endif
}
