"""A thin layer over moderngl: programs, textures and targets, made lazily, released explicitly."""
