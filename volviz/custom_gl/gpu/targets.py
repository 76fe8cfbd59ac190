"""Targets to draw into: float colour with depth, single-sample."""

from __future__ import annotations

from typing import Any


class Target:
    """A framebuffer with an RGBA32F colour texture and, on request, a depth texture.

    Attributes
    ----------
    size : tuple of 2 ints
        Width and height in pixels.
    color : moderngl.Texture
        Premultiplied RGBA, float32 (half floats for `half`).
    depth : moderngl.Texture or None
        Window depth 0..1.
    fbo : moderngl.Framebuffer
        Both of them.
    released : bool
        Whether it is gone: another size was asked for.
    """

    def __init__(
        self, context: Any, size: tuple[int, int], *, depth: bool = True, half: bool = False
    ) -> None:
        self.size = size
        self.released = False
        self.color = context.texture(size, 4, dtype="f2" if half else "f4")
        self.color.filter = (context.NEAREST, context.NEAREST)
        self.color.repeat_x = self.color.repeat_y = False
        self.depth = None
        if depth:
            self.depth = context.depth_texture(size)
            self.depth.compare_func = ""
            self.depth.filter = (context.NEAREST, context.NEAREST)
            self.depth.repeat_x = self.depth.repeat_y = False
        self.fbo = context.framebuffer([self.color], self.depth)

    def clear(self) -> None:
        """Transparent black, depth 1."""
        self.fbo.clear(0.0, 0.0, 0.0, 0.0, depth=1.0)

    def release(self) -> None:
        """Release framebuffer and textures; the context must be current."""
        self.released = True
        self.fbo.release()
        self.color.release()
        if self.depth is not None:
            self.depth.release()


class TargetPool:
    """Targets by purpose, remade when their size changes."""

    def __init__(self, context: Any) -> None:
        self._context = context
        self._targets: dict[str, tuple[Target, bool, bool]] = {}

    def get(self, purpose: str, size: tuple[int, int], *, depth: bool = True, half: bool = False) -> Target:
        """The target of that purpose at that size; its content is undefined after a change of size."""
        held = self._targets.get(purpose)
        if held is not None and held[0].size == size and held[1:] == (depth, half):
            return held[0]
        if held is not None:
            held[0].release()
        target = Target(self._context, size, depth=depth, half=half)
        self._targets[purpose] = (target, depth, half)
        return target

    def drop(self, purpose: str) -> None:
        """Release the target of a purpose, if there is one."""
        held = self._targets.pop(purpose, None)
        if held is not None:
            held[0].release()

    def release(self) -> None:
        """Release all targets."""
        for purpose in list(self._targets):
            self.drop(purpose)
