// A fixed pseudo-random number in 0..1 per pixel (interleaved gradient noise, Jimenez 2014); `seed` shifts the pattern.
float pixel_noise(vec2 pixel, float seed) {
    pixel += seed * vec2(5.588238, 2.345678);
    return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715))));
}
