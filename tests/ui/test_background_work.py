"""The window never waits for a thread, whatever is made in the background while it draws."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import replace

import pytest
from PySide6.QtWidgets import QApplication

from tests.ui.conftest import is_complete, settle
from tests.waiting import refuse_to_wait
from volviz.custom_gl.scene_techniques import current_settings
from volviz.model.store import Store
from volviz.tasks import THREAD_NAME
from volviz_ui.app.main_window import MainWindow
from volviz_ui.session.gui_thread import Delivery
from volviz_ui.views.frame_scheduler import QtFrameScheduler

Wait = Callable[..., None]

#: Techniques that have something made in the background, and values that make them do so again.
MADE_IN_THE_BACKGROUND = {
    "marching_cubes": ({"isovalue": 60.0}, {"smoothing": 2}),
    "marching_tetrahedra": ({"isovalue": 60.0},),
    "splatting": ({"isovalue": 60.0}, {"footprint": "gaussian"}),
    "bump_mapping": ({"surface": "mesh"}, {"isovalue": 60.0}),
    "reference": ({"step": 2.0},),
    "vtk_flying_edges": ({"isovalue": 60.0},),
    "vtk_point_gaussian": ({"isovalue": 60.0},),
    "vtk_normal_map": ({"texels": 64},),
}


def change(window: MainWindow, technique: str, **values: object) -> None:
    """Choose a technique, and settings of it, as the panel does."""
    store = window.store
    store.update(lambda scene: scene.with_view(technique=technique))
    if values:
        settings = replace(current_settings(store.scene), **values)
        view = store.scene.view.with_settings(technique, settings)
        store.update(lambda scene: scene.with_view(settings=view.settings))


@pytest.mark.parametrize("technique", MADE_IN_THE_BACKGROUND)
def test_the_window_never_waits_for_a_thread(
    technique: str, window: MainWindow, wait_for: Wait, monkeypatch: pytest.MonkeyPatch, qapp: QApplication
) -> None:
    with monkeypatch.context() as patch:
        tried = refuse_to_wait(patch)
        change(window, technique)
        wait_for(lambda: is_complete(window))
        for values in MADE_IN_THE_BACKGROUND[technique]:
            before = window.viewport.frames
            change(window, technique, **values)
            # a gesture begins while it is made
            window.store.begin_gesture("test")
            settle(qapp)
            window.store.end_gesture("test")
            wait_for(lambda: is_complete(window))
            assert window.viewport.frames > before
        assert window.views.active.controller.handle.error is None
        change(window, technique)
        window.close()
        settle(qapp)
    assert tried == []


def test_a_drag_of_the_isovalue_shows_new_meshes_while_it_lasts(window: MainWindow, wait_for: Wait) -> None:
    change(window, "marching_cubes")
    wait_for(lambda: is_complete(window))
    controller = window.views.active.controller
    shown: list[float] = []
    series = [50.0, 70.0, 90.0, 110.0, 130.0, 150.0]

    def note(_status: object) -> None:
        technique = controller.handle._runner.technique
        blocks = technique._shown[True].blocks
        now = None if blocks is None else blocks.mesh.request.isovalue
        if now in series and now not in shown[-1:]:
            shown.append(now)

    controller.handle.on_status.append(note)
    window.store.begin_gesture("test")
    controller.handle._cost.observe(controller.handle._image.level, 1.0)
    for isovalue in series:
        change(window, "marching_cubes", isovalue=isovalue)
        # nothing moves any more: the mesh comes by itself
        wait_for(lambda isovalue=isovalue: shown[-1:] == [isovalue])
    assert shown == series
    window.store.end_gesture("test")
    wait_for(lambda: is_complete(window))
    assert controller.handle.mesh.request.isovalue == 150.0


def test_a_wake_reaches_the_window_from_any_thread_and_not_what_has_gone(
    qapp: QApplication, wait_for: Wait
) -> None:
    store = Store()
    pacer = QtFrameScheduler(store)
    frames: list[int] = []
    pacer.frame_wanted.connect(lambda: frames.append(threading.get_ident()))
    store.begin_gesture("test")

    thread = threading.Thread(target=pacer.wake, args=(None,), name=f"{THREAD_NAME} test")
    thread.start()
    thread.join()
    assert frames == []
    wait_for(lambda: frames)
    assert frames == [threading.get_ident()]
    late = Delivery(pacer._on_woken)
    pacer.deleteLater()
    del pacer, thread
    settle(qapp)
    late()
    settle(qapp)
    assert len(frames) == 1
