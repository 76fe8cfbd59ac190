"""A handle that is told nothing new keeps the finished image."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
import pyvista

import volviz
from tests.render.scenes import camera, function, volume
from volviz.custom_gl.offscreen import apply_camera


@contextmanager
def shown() -> Iterator[tuple[Any, volviz.VolumeHandle]]:
    of = volume()
    window = pyvista.Plotter(off_screen=True, window_size=(80, 60))
    handle = volviz.add_volume(window, of, transfer_function=function(of), step=0.7)
    apply_camera(window.camera, camera(of))
    window.reset_camera_clipping_range()
    window.show(auto_close=False)
    yield window, handle
    window.close()


def test_nothing_new_keeps_the_picture() -> None:
    with shown() as (window, handle):
        before, statuses = handle.read_image(), []
        handle.on_status.append(statuses.append)
        equal = volviz.TransferFunction.from_dict(handle.transfer_function.to_dict())
        for nothing in (
            {},
            {"step": 0.7},
            {"settings": replace(handle.settings)},
            {"technique": "raycast"},
            {"volume": handle.volume},
            {"transfer_function": equal},
            {"light": volviz.Light(), "clipping": volviz.Clipping()},
            {"quality": "fast"},
        ):
            handle.update(**nothing)
            np.testing.assert_array_equal(handle.read_image(), before, err_msg=str(nothing))
            window.render()
        handle.show(handle.spec)
        np.testing.assert_array_equal(handle.read_image(), before)
        assert statuses == []


def test_something_new_or_invalid_draws_anew() -> None:
    with shown() as (window, handle):
        statuses: list[Any] = []
        handle.on_status.append(statuses.append)
        before = handle.read_image()
        handle.update(step=1.4)
        window.render()
        assert len(statuses) == 1
        assert np.abs(handle.read_image() - before).max() > 0
        handle.update(step=0.7)
        handle.invalidate()
        window.render()
        assert len(statuses) == 2
        np.testing.assert_array_equal(handle.read_image(), before)
        handle.invalidate()
        window.render()
        assert len(statuses) == 3


def test_the_same_once_more_after_a_failure_tries_again() -> None:
    with shown() as (window, handle):
        before = handle.read_image()
        handle.invalidate()
        handle.error = RuntimeError("the driver was busy")
        window.render()
        assert handle.error is not None
        handle.update()
        assert handle.error is None
        window.render()
        np.testing.assert_array_equal(handle.read_image(), before)
