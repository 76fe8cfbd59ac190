// First pass: the position on the box's face as colour. Alpha 1 tells it from pixels that no face covers.
in vec3 v_position;
out vec4 f_color;

void main() { f_color = vec4(v_position, 1.0); }
