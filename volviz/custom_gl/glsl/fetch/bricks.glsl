// Hook <fetch>: stored values from bricks of several levels, which lie anywhere in one texture
// (gpu/brick_resources.py, volume_data/brick_cache).
#pragma per_layer

uniform sampler3D t_scalars;      // the atlas
uniform sampler3D t_pages;        // for each cell of the volume: where its brick lies in the atlas, and its level
uniform sampler2D t_page_scales;  // for each level: voxel indices of the finest level -> texture coordinates of the atlas
uniform vec3 u_cells_per_voxel;
uniform vec3 u_last_cell;         // number of cells - 1
uniform vec3 u_cell_edge;         // of a cell in the texture = 1 / number of cells
uniform float u_level_edge;       // of a level in the texture = 1 / number of levels

float fetch(vec3 p) {
    vec3 index = clamp(p * u_voxels - 0.5, vec3(0.0), u_voxels - 1.0);
    vec3 cell = min(floor(index * u_cells_per_voxel), u_last_cell);
    vec4 page = textureLod(t_pages, (cell + 0.5) * u_cell_edge, 0.0);
    vec3 scale = textureLod(t_page_scales, vec2((page.w + 0.5) * u_level_edge, 0.5), 0.0).xyz;
    return textureLod(t_scalars, index * scale + page.xyz, 0.0).r;
}
