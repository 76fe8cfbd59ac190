// Hook <fetch>: stored values of the volume, from one 3D texture.
#pragma per_layer

uniform sampler3D t_scalars;

float fetch(vec3 p) { return textureLod(t_scalars, p, 0.0).r; }
