// Edges of the slice polygons; those behind others fade.
uniform vec4 u_outline_color;   // premultiplied
out vec4 f_color;

void main() { f_color = u_outline_color; }
