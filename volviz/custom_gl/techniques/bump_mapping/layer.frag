// A layer that was drawn in two passes, over what lies behind it.
uniform sampler2D t_layer;
uniform sampler2D t_layer_depth;
out vec4 f_color;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    f_color = texelFetch(t_layer, pixel, 0);
    if (f_color.a <= 0.0) discard;
    gl_FragDepth = texelFetch(t_layer_depth, pixel, 0).r;
}
