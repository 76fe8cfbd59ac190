"""The ray inspector: a click in the picture shows the ray behind that pixel, sample by sample."""
