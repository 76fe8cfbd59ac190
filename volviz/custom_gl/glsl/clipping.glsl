// Crop box and clip planes: which points and which part of a ray are shown. Everything in texture coordinates.
// The number of planes is a define: software rasterisers pay for a loop over a uniform number even where it is zero.

uniform vec3 u_box_low;
uniform vec3 u_box_high;
#if CLIP_PLANES
uniform vec4 u_planes[CLIP_PLANES];   // dot(plane.xyz, p) + plane.w >= 0 is kept; its length is the volume's, or nearly
#endif

// What rounding may take a point beyond a face that it lies in.
const float CLIP_TOLERANCE = 1e-6;

struct Ray {
    vec3 origin;      // texture coordinates
    vec3 direction;   // change of texture coordinates per world unit
    float near;       // world length from the origin to the first shown point
    float far;        // ... to the last one; nothing is shown when far <= near
};

bool is_cropped(vec3 p) {
    return any(lessThan(p, u_box_low - CLIP_TOLERANCE)) || any(greaterThan(p, u_box_high + CLIP_TOLERANCE));
}

bool is_clipped(vec3 p) {
#if CLIP_PLANES
    for (int i = 0; i < CLIP_PLANES; ++i) {
        if (dot(u_planes[i].xyz, p) + u_planes[i].w < -CLIP_TOLERANCE) return true;
    }
#endif
    return false;
}

// Entry and exit of a box, as world lengths along the ray (slabs method, Kay & Kajiya 1986).
void intersect_slabs(inout Ray ray, vec3 box_low, vec3 box_high) {
    vec3 inverse = 1.0 / (ray.direction + vec3(equal(ray.direction, vec3(0.0))) * 1e-20);
    vec3 a = (box_low - ray.origin) * inverse;
    vec3 b = (box_high - ray.origin) * inverse;
    vec3 low = min(a, b), high = max(a, b);
    ray.near = max(ray.near, max(low.x, max(low.y, low.z)));
    ray.far = min(ray.far, min(high.x, min(high.y, high.z)));
}

// The same for the box of what is shown.
void intersect_box(inout Ray ray) { intersect_slabs(ray, u_box_low, u_box_high); }

void intersect_planes(inout Ray ray) {
#if CLIP_PLANES
    for (int i = 0; i < CLIP_PLANES; ++i) {
        float start = dot(u_planes[i].xyz, ray.origin) + u_planes[i].w;
        float slope = dot(u_planes[i].xyz, ray.direction);
        if (slope > 0.0) ray.near = max(ray.near, -start / slope);
        else if (slope < 0.0) ray.far = min(ray.far, -start / slope);
        else if (start < 0.0) ray.far = -1e30;
    }
#endif
}
