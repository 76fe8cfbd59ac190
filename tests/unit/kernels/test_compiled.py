"""Kernels are compiled when they are first called, and only then is numba imported."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from volviz.kernels import gradient
from volviz.kernels.compiled import Kernel, compiled


@compiled
def doubled(x):
    return 2 * x


@compiled
def doubled_and_one(x):
    return doubled(x) + 1


def output_of(program: str) -> str:
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def test_a_kernel_calls_another_kernel_in_compiled_code():
    kernel = doubled_and_one
    assert kernel(3) == 7
    assert len(kernel.signatures) == 1
    # the names in the module stand for numba's own objects now
    assert not isinstance(doubled_and_one, Kernel)
    assert not isinstance(doubled, Kernel)
    assert doubled(2.5) == 5.0


def test_a_kernel_keeps_name_and_description():
    def described(x):
        """What it does."""
        return x

    kernel = compiled(described)
    assert (kernel.__name__, kernel.__doc__) == ("described", "What it does.")
    assert "described" in repr(kernel)
    assert kernel.signatures == []


def test_the_kernels_of_gradients_work_whichever_is_called_first():
    magnitude = gradient.gradient_statistics(np.arange(27.0).reshape(3, 3, 3), (1, 1, 1)).maximum
    assert magnitude == pytest.approx(np.sqrt(1 + 9 + 81), rel=1e-6)


def test_a_volume_is_prepared_for_its_first_picture_without_numba():
    program = """
import sys
import numpy as np
import pytest
import volviz
from volviz.volume_data.scalars import bricks_of, levels_of
from volviz.custom_gl.registry import techniques
from volviz.kernels.bricks import chessboard_distance, occupancy, visible_prefix
from volviz.model.auto_isovalue import auto_isovalue
techniques()
for dtype in (np.uint8, np.int16, np.float32):
    volume = volviz.Volume(np.arange(32 ** 3).reshape(32, 32, 32).astype(dtype))
    volviz.TransferFunction.auto(volume)
    auto_isovalue(volume)
    bricks = bricks_of(volume)
    levels_of(volume, "f4", 2048, 2 ** 30)
    chessboard_distance(occupancy(bricks.low, bricks.high, visible_prefix([0, 0, 1]), volume.range))
print("numba" in sys.modules)
"""
    assert output_of(program) == "False"
