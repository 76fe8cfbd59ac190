// One row of texture look-ups along x, for the start-up test of filter precision.
uniform sampler3D t_probe;
in vec2 v_ndc;
out vec4 f_color;

void main() {
    f_color = vec4(textureLod(t_probe, vec3(v_ndc.x * 0.5 + 0.5, 0.5, 0.5), 0.0).r);
}
