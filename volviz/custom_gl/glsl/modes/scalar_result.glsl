// Colour of a ray whose result is one scalar: classified once, premultiplied.
vec4 classified_result(float s) {
    vec4 c = classify(s);
    return vec4(c.rgb * c.a, c.a);
}
