// The light buffer as an image, as large as fits.
uniform sampler2D t_light;
uniform vec2 u_size;

in vec2 v_ndc;
out vec4 f_color;

void main() {
    vec2 position = v_ndc * u_size / min(u_size.x, u_size.y) * 0.5 + 0.5;
    if (any(lessThan(position, vec2(0.0))) || any(greaterThan(position, vec2(1.0)))) discard;
    f_color = vec4(textureLod(t_light, position, 0.0).rgb, 1.0);
}
