"""One folder a technique; `volviz.custom_gl.registry` finds them."""
