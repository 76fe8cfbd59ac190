"""NumPy's own format: the values alone, axes (t, c, z, y, x) as far as there are any."""

from __future__ import annotations

from typing import TYPE_CHECKING

from numpy.lib import format as npy

if TYPE_CHECKING:
    from volviz.io.writers.content import Content
    from volviz.io.writers.request import SaveRequest


def write(content: Content, request: SaveRequest) -> None:
    """Write what there is; the components of colours are the last axis, as everywhere in NumPy's world."""
    leading = [n for n in (content.time_count, content.channel_count) if n]
    shape = (*leading, *content.shape)
    if content.is_colour:
        shape = (*leading[:-1], *content.shape, leading[-1])
    with request.path.open("wb") as file:
        header = {"descr": npy.dtype_to_descr(content.dtype), "fortran_order": False, "shape": shape}
        npy.write_array_header_1_0(file, header)
        for array, span in content.pieces(request):
            request.write(file, array, *span)
