"""An empty picture says why, and its button mends it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from tests.ui.conftest import foreground
from volviz.model.clipping import Clipping
from volviz_ui.app.main_window import MainWindow

pytestmark = pytest.mark.leaks_allowed("the tests share a window, which is searched when the file ends")

Wait = Callable[..., None]


def test_a_transparent_function_is_said_and_mended(same_window: MainWindow, wait_for: Wait) -> None:
    banner = same_window.messages.banner
    assert banner.isHidden()
    function = same_window.store.scene.layer.transfer_function
    same_window.store.update(
        lambda scene: scene.with_layer(transfer_function=function.with_opacity(0.0)), label="Opacity"
    )
    wait_for(lambda: not banner.isHidden())
    assert "transparent" in banner.words.text()
    assert banner.details.isHidden()
    banner.cure.click()
    wait_for(lambda: same_window.views.is_complete and foreground(same_window).mean() > 0.02)
    assert banner.isHidden()


def test_a_cut_that_leaves_nothing_is_said_and_mended(same_window: MainWindow, wait_for: Wait) -> None:
    banner = same_window.messages.banner
    far = Clipping(planes=(((1000.0, 0.0, 0.0), (1.0, 0.0, 0.0)),))
    same_window.store.update(lambda scene: replace(scene, clipping=far), label="Cut")
    wait_for(lambda: not banner.isHidden())
    assert "clip planes" in banner.words.text()
    same_window.documents.undo()
    wait_for(banner.isHidden)
    same_window.documents.redo()
    wait_for(lambda: not banner.isHidden())
    banner.cure.click()
    assert same_window.store.scene.clipping == Clipping()
