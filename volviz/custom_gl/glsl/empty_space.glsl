// Jumps over bricks in which nothing is visible. Sample positions are kept: a ray goes on at a later sample of the
// same sequence, so the image is that of a march without jumps.
#pragma per_layer

uniform sampler3D t_distance;      // up to 127: bricks to the nearest visible one; 128 + n: visible, and so are all
                                   // bricks at most n away
uniform vec3 u_bricks_per_texture; // bricks per unit of texture coordinate = voxels / brick size
uniform vec3 u_brick_offset;       // -0.5 / brick size: voxel i has its centre at (i + 0.5) / N
uniform vec3 u_last_brick;         // number of bricks - 1
uniform vec3 u_brick_edge;         // of a brick in the texture = 1 / number of bricks
uniform vec3 u_first_brick;        // middle of the first one, in bricks, where fields of several lattices share a texture

// Where the field lies: in a texture of its own, or in one with those of other lattices.
#ifndef DISTANCES
#define DISTANCES t_distance
#define FIRST_BRICK 0.5
#endif

struct Brick {
    bool visible;      // something may be visible in it
    float clearance;   // all bricks at most so many away are visible, or invisible, alike
    vec3 position;     // of the point, in bricks
    vec3 corner;       // of the brick that holds it
};

Brick brick_at(vec3 p) {
    Brick b;
    b.position = p * u_bricks_per_texture + u_brick_offset;
    b.corner = clamp(floor(b.position), vec3(0.0), u_last_brick);
    float code = textureLod(DISTANCES, (b.corner + FIRST_BRICK) * u_brick_edge, 0.0).r;
    b.visible = code > 127.0;
    b.clearance = b.visible ? code - 128.0 : code - 1.0;
    return b;
}

// 1 / change of the position in bricks per world unit along a ray, for `clear_length`.
vec3 inverse_in_bricks(vec3 direction) {
    return 1.0 / (direction * u_bricks_per_texture + vec3(equal(direction, vec3(0.0))) * 1e-20);
}

// World length from the point of a brick to where its ray leaves the block of bricks that are visible, or not, alike.
float clear_length(Brick b, vec3 inverse_direction) {
    vec3 low = b.corner - b.clearance;
    vec3 high = b.corner + (1.0 + b.clearance);
    vec3 ahead = mix(low, high, greaterThan(inverse_direction, vec3(0.0)));
    vec3 t = (ahead - b.position) * inverse_direction;
    return max(min(t.x, min(t.y, t.z)), 0.0);
}
