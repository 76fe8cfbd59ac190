// The scalar, weakened by the integral of the slices in front of it, blended with MAX.
#pragma per_layer

uniform sampler2D t_integral;    // of the scalar, in opacity unit distances
uniform float u_attenuation;

vec4 slice_color(float s, vec3 p, float segment_length) {
    float integral = texelFetch(t_integral, ivec2(gl_FragCoord.xy), 0).a;
    return vec4(clamp(s, 0.0, 1.0) * exp(-u_attenuation * integral));
}
