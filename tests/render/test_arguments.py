"""What the public functions say to values of the wrong kind."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import volviz
from volviz.errors import InputError

VOLUME = volviz.Volume(np.arange(27.0).reshape(3, 3, 3))


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"transfer_function": "ct-bone"}, "transfer_function must be a volviz.TransferFunction, got str"),
        ({"light": (1.0, 2.0, 3.0)}, "light must be a volviz.Light, got tuple"),
        ({"clipping": (0, 1, 0, 1, 0, 1)}, "clipping must be a volviz.Clipping, got tuple"),
        ({"settings": {"step": 1.0}}, "raycast takes RaycastSettings, got dict"),
        ({"volume": VOLUME.array}, "volume must be a volviz.Volume, got ndarray"),
        ({"volume": None}, "no volume to show"),
    ],
)
def test_a_value_of_another_kind_is_refused_before_anything_is_drawn(
    values: dict[str, Any], words: str
) -> None:
    with pytest.raises(InputError, match=words):
        volviz.render(**({"volume": VOLUME} | values))
