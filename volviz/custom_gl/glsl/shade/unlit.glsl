// Hook <shade>: colours as they are classified.
#pragma per_layer

vec3 shade(vec3 color, vec3 gradient, vec3 p) { return color; }
