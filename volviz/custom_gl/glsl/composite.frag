// The finished image over VTK's, premultiplied. A smaller image is enlarged bilinearly, but only between samples
// that lie on the same side of opaque geometry: the weights fall with the difference of scene depth, so that no halo
// forms around a mesh.

uniform sampler2D t_image;
uniform float u_weight;     // 1 / number of images summed up in it
#if SCENE_DEPTH
uniform sampler2D t_scene_depth;
#endif
uniform vec2 u_image_size;
uniform vec2 u_depth_map;   // z_eye = x / (z_window - y) up to sign (perspective), see host

in vec2 v_ndc;
out vec4 f_color;

#if SCENE_DEPTH
float scene_depth(vec2 uv) {
    float z = textureLod(t_scene_depth, uv, 0.0).r;
    return u_depth_map.x == 0.0 ? z : u_depth_map.x / (u_depth_map.y - z);
}
#endif

void main() {
    vec2 uv = v_ndc * 0.5 + 0.5;
#if !ENLARGE
    f_color = u_weight * texelFetch(t_image, ivec2(uv * u_image_size), 0);
#elif !SCENE_DEPTH
    // nothing to keep apart: the texture's own linear filter
    f_color = u_weight * textureLod(t_image, uv, 0.0);
#else
    vec2 position = uv * u_image_size - 0.5;
    vec2 low = floor(position);
    vec2 part = position - low;
    float here = scene_depth(uv);
    vec4 sum = vec4(0.0);
    float total = 0.0;
    for (int i = 0; i < 4; ++i) {
        ivec2 corner = ivec2(i & 1, i >> 1);
        vec2 texel = clamp(low + vec2(corner), vec2(0.0), u_image_size - 1.0);
        vec2 w2 = mix(1.0 - part, part, vec2(corner));
        float w = w2.x * w2.y + 1e-5;
        float there = scene_depth((texel + 0.5) / u_image_size);
        w *= 1.0 / (1e-4 + abs(there - here) / max(abs(here), 1e-6));
        sum += w * texelFetch(t_image, ivec2(texel), 0);
        total += w;
    }
    f_color = u_weight * sum / total;
#endif
}
