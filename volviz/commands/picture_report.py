"""What of the data a picture shows, as a file: ``volviz render --report``."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from volviz.errors import VolvizError

if TYPE_CHECKING:
    from volviz.model.layers import ImageLayer, LabelLayer
    from volviz.volume_data.brick_cache.cache import BrickStatus


def write_report(
    output: Path, layers: Sequence[ImageLayer | LabelLayer], bricks: BrickStatus | None, seconds: float
) -> None:
    """Write what of the data a picture shows: levels, bricks, bytes.

    Raises
    ------
    VolvizError
        The file cannot be written.
    """
    from volviz.model.layers import volume_of
    from volviz.volume_data.finer_levels import levels_behind

    volume = volume_of(layers[0])
    finer = levels_behind(volume)
    levels = (
        [volume.dimensions]
        if finer is None
        else [each.dimensions for each in finer.levels[: finer.stored_count]]
    )
    report: dict[str, Any] = {
        "levels": [list(dimensions) for dimensions in levels],
        "level_in_memory": 0 if finer is None else finer.held_level,
        "level": finer.held_level if finer is not None and bricks is None else 0,
        "bytes_in_memory": int(volume.array.nbytes),
        "bricks": None,
        "seconds": seconds,
    }
    if bricks is not None:
        report["level"] = bricks.level
        report["bricks"] = {
            "needed": bricks.needed, "present": bricks.present, "failed": bricks.failed,
            "bytes": bricks.held_bytes, "complete": bricks.is_complete, "limited_by_budget": bricks.limited,
        }  # fmt: skip
    try:
        output.write_text(json.dumps(report, indent=1), encoding="utf-8")
    except OSError as error:
        raise VolvizError(f"{output}: the report cannot be written ({error.strerror or error}).") from None
