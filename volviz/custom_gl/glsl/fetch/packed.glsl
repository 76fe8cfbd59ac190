// Hook <fetch>: stored values of a layer, from a texture that holds those of up to four layers of one lattice.
// PACK is its sampler, COMPONENT the layer's place in it.
#pragma per_layer

uniform sampler3D t_scalars;

float fetch(vec3 p) { return textureLod(PACK, p, 0.0)[COMPONENT]; }
