// Depth of the surfaces in the finished image, written into VTK's depth buffer.
uniform sampler2D t_image_depth;
in vec2 v_ndc;
out vec4 f_color;

void main() {
    float depth = textureLod(t_image_depth, v_ndc * 0.5 + 0.5, 0.0).r;
    if (depth >= 1.0) discard;
    gl_FragDepth = depth;
    f_color = vec4(0.0);
}
