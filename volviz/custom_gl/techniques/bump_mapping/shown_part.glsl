// The part of the volume that is shown: within the clip planes and, for meshes, the crop box. Flat surfaces are cut
// with the box beforehand.
uniform vec3 u_box_low;
uniform vec3 u_box_high;
uniform int u_plane_count;
uniform vec4 u_planes[6];

bool is_shown(vec3 p) {
    for (int i = 0; i < u_plane_count; ++i) {
        if (dot(u_planes[i].xyz, p) + u_planes[i].w < -1e-6) return false;
    }
#if MESH
    if (any(lessThan(p, u_box_low - 1e-6)) || any(greaterThan(p, u_box_high + 1e-6))) return false;
#endif
    return true;
}
