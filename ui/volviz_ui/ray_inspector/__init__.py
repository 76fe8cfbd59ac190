"""The ray inspector: a click in the image shows the ray behind that pixel, sample by sample."""
