"""Meshes in a window: extraction on a worker, the newest isovalue, LOD meshes, chunks, release."""

from __future__ import annotations

import threading
import time
from typing import Any

import numpy as np
import pytest

import volviz
from tests.render import scenes
from tests.render.scenes import Requests, blobs
from tests.waiting import refuse_to_wait
from volviz.custom_gl.mesh_drawing import blocks, technique
from volviz.custom_gl.mesh_drawing.mesh import MeshRequest, ReadyMesh
from volviz.custom_gl.vtk.frame_scheduling import BUDGET, FULL, CostModel, QualityLevel
from volviz.errors import RenderError
from volviz.kernels import marching
from volviz.kernels.marching import marching_cubes
from volviz.tasks import THREAD_NAME

SIZE = (160, 120)


class SlowExtraction:
    """Takes the place of the kernel and waits for a word before it works."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.go = threading.Event()
        self.isovalues: list[float] = []
        self.strides: list[int] = []
        monkeypatch.setattr(marching, "marching_cubes", self)

    def __call__(self, scalars: Any, isovalue: float, **options: Any) -> Any:
        self.isovalues.append(isovalue)
        self.strides.append(options["stride"])
        while not self.go.wait(0.005):
            if options["cancel"]():
                break
        return marching_cubes(scalars, isovalue, **options)


def shown(of: volviz.Volume, pacer: Any = None, **values: Any) -> Any:
    """A window that shows a mesh, and its handle."""
    return scenes.shown(of, "marching_cubes", SIZE, pacer=pacer, **values)


def field() -> volviz.Volume:
    return volviz.Volume(blobs((49, 49, 49), np.float32))


def complete(window: Any, handle: Any) -> Any:
    """The full image, drawn turn by turn."""
    end = time.monotonic() + 30
    while not handle.refine(0.01):
        assert time.monotonic() < end, "the picture is never complete"
    window.render()
    handle.raise_error()
    return handle.read_image()


def alone(of: volviz.Volume, isovalue: float) -> Any:
    """The image without a frame scheduler."""
    with shown(of, isovalue=isovalue) as (_, handle):
        handle.raise_error()
        return handle.read_image()


# ---------------------------------------------------------------------- the worker


def test_the_window_goes_on_while_a_mesh_is_extracted(monkeypatch: pytest.MonkeyPatch) -> None:
    of = field()
    exact = alone(of, 0.6)
    pacer = Requests()
    with shown(of, pacer, isovalue=0.4) as (window, handle):
        before = complete(window, handle)
        slow = SlowExtraction(monkeypatch)
        handle.update(isovalue=0.6)
        asked = pacer.count
        window.render()
        assert pacer.count > asked
        for _ in range(5):
            begin = time.perf_counter()
            assert not handle.refine(0.03)
            # what a busy machine adds
            assert time.perf_counter() - begin < 0.5
            assert handle.is_waiting
            assert not handle.status.complete
            window.render()
            handle.raise_error()
        assert window.screenshot(return_img=True).std() > 5, "the last picture is gone"
        slow.go.set()
        after = complete(window, handle)
    assert np.abs(after - exact).max() <= 1 / 255
    assert np.abs(after - before).max() > 0.1


def test_of_many_isovalues_the_newest_is_extracted(monkeypatch: pytest.MonkeyPatch) -> None:
    of = field()
    exact = alone(of, 0.7)
    with shown(of, Requests(), isovalue=0.4) as (window, handle):
        complete(window, handle)
        slow = SlowExtraction(monkeypatch)
        for isovalue in np.linspace(0.45, 0.7, 26):
            handle.update(isovalue=float(isovalue))
            handle.refine(0.001)
        slow.go.set()
        last = complete(window, handle)
        assert slow.isovalues[-1] == pytest.approx(0.7)
    assert np.abs(last - exact).max() <= 1 / 255


def test_an_extraction_that_nobody_wants_is_cancelled(monkeypatch: pytest.MonkeyPatch) -> None:
    slow = SlowExtraction(monkeypatch)
    with shown(field(), Requests(), isovalue=0.4) as (window, handle):
        for isovalue in (0.4, 0.6):
            handle.update(isovalue=isovalue)
            while isovalue not in slow.isovalues:
                assert not handle.refine(0.01)
                time.sleep(0.005)
        # nobody has given the word to the first one
        assert slow.isovalues == [0.4, 0.6]
        slow.go.set()
        complete(window, handle)
        assert handle.mesh.request.isovalue == 0.6
        assert slow.isovalues == [0.4, 0.6]


def test_every_frame_of_a_drag_shows_a_newer_mesh(monkeypatch: pytest.MonkeyPatch) -> None:
    # a machine so slow that full images are out of the question
    monkeypatch.setattr(CostModel, "level", lambda self, quality, share=1.0: QualityLevel(0.5))
    drawn: list[float] = []
    draw = blocks.MeshBlocks.draw

    def noted(self: Any, block: int, program: Any) -> None:
        if block == 0:
            drawn.append(self.mesh.request.isovalue)
        draw(self, block, program)

    monkeypatch.setattr(blocks.MeshBlocks, "draw", noted)
    pacer = Requests()
    with shown(field(), pacer, isovalue=0.4) as (window, handle):
        complete(window, handle)
        handle.begin_interaction()
        drawn.clear()
        series = [round(float(isovalue), 4) for isovalue in np.linspace(0.41, 0.6, 20)]
        for isovalue in series:
            handle.update(isovalue=isovalue)
            wakes = pacer.wakes
            window.render()
            handle.wait()
            handle.raise_error()
            assert pacer.wakes == wakes + 1, "one mesh is made for each isovalue"
        # each was drawn while the next one was extracted
        assert drawn == series[:-1]
        # woken, the window draws the last one though nothing else has changed
        window.render()
        assert drawn[-1] == series[-1]
        window.render()
        assert len(drawn) == len(series), "nothing new, nothing drawn"
        handle.end_interaction()


def test_nobody_waits_for_an_extraction_in_a_window(monkeypatch: pytest.MonkeyPatch) -> None:
    slow = SlowExtraction(monkeypatch)
    with shown(field(), Requests(), isovalue=0.4) as (window, handle):
        handle.wait()
        with monkeypatch.context() as patch:
            tried = refuse_to_wait(patch)
            for isovalue in (0.4, 0.5, 0.6):
                handle.update(isovalue=isovalue)
                assert not handle.refine(0.01)
                window.render()
                handle.begin_interaction()
                window.render()
                handle.end_interaction()
            handle.update(technique="raycast")
            window.render()
            handle.raise_error()
            assert tried == []
        assert slow.isovalues


def test_what_the_extraction_raises_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: Any, **__: Any) -> Any:
        raise RenderError("there is no memory left for the mesh; choose a larger stride.")

    monkeypatch.setattr(marching, "marching_cubes", fail)
    with shown(field(), isovalue=0.4) as (_, handle), pytest.raises(RenderError, match="larger stride"):
        handle.raise_error()


def test_taking_the_volume_away_ends_the_worker(monkeypatch: pytest.MonkeyPatch) -> None:
    slow = SlowExtraction(monkeypatch)
    with shown(field(), Requests(), isovalue=0.4) as (_, handle):
        end = time.monotonic() + 30
        while not slow.isovalues:
            # the scalars are uploaded first
            assert not handle.refine(0.01)
            assert time.monotonic() < end
        working = [thread for thread in threading.enumerate() if thread.name == f"{THREAD_NAME} mesh"]
        assert len(working) == 1
    # cancelled, not waited for
    working[0].join(20)
    assert not working[0].is_alive()
    assert not slow.go.is_set()


# ---------------------------------------------------------------------- LOD meshes


def test_a_coarser_mesh_stands_in_while_something_moves(monkeypatch: pytest.MonkeyPatch) -> None:
    of = field()
    monkeypatch.setattr(technique, "LOD_MESH_TRIANGLES", 1500)
    monkeypatch.setattr(technique, "LOD_MESH_TRIANGLES_HARDWARE", 1500)
    # a machine so slow that full images are out of the question
    monkeypatch.setattr(CostModel, "level", lambda self, quality, share=1.0: QualityLevel(0.5))
    drawn: list[int] = []
    draw = blocks.MeshBlocks.draw

    def noted(self: Any, block: int, program: Any) -> None:
        if block == 0:
            drawn.append(self.mesh.triangles)
        draw(self, block, program)

    monkeypatch.setattr(blocks.MeshBlocks, "draw", noted)
    with shown(of, Requests(), isovalue=0.4) as (window, handle):
        full = complete(window, handle)
        handle.begin_interaction()
        drawn.clear()
        window.camera.Azimuth(3)
        window.render()
        assert drawn == [], "the picture stays until there is a stand-in"
        handle.wait()
        window.render()
        handle.raise_error()
        assert len(drawn) == 1
        assert 100 < drawn[0] <= 1500
        window.camera.Azimuth(-3)
        handle.end_interaction()
        again = complete(window, handle)
        assert drawn[-1] > 4000
    assert np.abs(again - full).max() <= 1 / 255


def test_small_meshes_need_no_stand_in(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(CostModel, "level", lambda self, quality, share=1.0: QualityLevel(0.5))
    with shown(volviz.Volume(blobs(dtype=np.float32)), Requests(), isovalue=0.4) as (window, handle):
        complete(window, handle)
        slow = SlowExtraction(monkeypatch)
        handle.begin_interaction()
        window.camera.Azimuth(3)
        window.render()
        handle.raise_error()
        assert not slow.isovalues
        handle.end_interaction()


def test_interaction_never_takes_a_full_picture_for_cheap_because_stand_ins_are() -> None:
    cost = CostModel()
    cost.observe(FULL, 0.8)
    for _ in range(100):
        level = cost.level("balanced")
        assert level != FULL
        # the LOD mesh takes the same short time at each level
        cost.observe(level, 0.01)
    assert level.fraction == 0.75
    assert cost.full_seconds == pytest.approx(0.8)
    cost.observe(FULL, BUDGET["balanced"] / 2)
    assert cost.level("balanced") == FULL


def test_resolution_is_not_given_up_where_triangles_cost() -> None:
    with shown(field(), Requests(), isovalue=0.4) as (window, handle):
        complete(window, handle)
        handle.begin_interaction()
        for _ in range(3):
            window.camera.Azimuth(3)
            handle._cost.observe(QualityLevel(0.125, 4.0), 5.0)
            window.render()
            handle.raise_error()
            assert handle.status.resolution == technique.MeshTechnique.least_resolution
        handle.end_interaction()


# ---------------------------------------------------------------------- buffers


def test_moving_the_camera_and_changing_looks_uploads_nothing() -> None:
    with shown(field(), isovalue=0.4) as (window, handle):
        uploads = handle.gpu.uploads
        window.camera.Azimuth(30)
        window.render()
        handle.update(color=(1.0, 0.0, 0.0), ambient=0.4, crop=(0, 30, 0, 48, 0, 48))
        window.render()
        handle.raise_error()
        assert handle.gpu.uploads == uploads
        handle.update(isovalue=0.5)
        window.render()
        handle.raise_error()
        assert handle.gpu.uploads > uploads


def test_only_the_shown_mesh_stays_on_the_gpu(monkeypatch: pytest.MonkeyPatch) -> None:
    alive: set[int] = set()
    begin, release = blocks.MeshBlocks.__init__, blocks.MeshBlocks.release

    def made(self: Any, *arguments: Any) -> None:
        begin(self, *arguments)
        alive.add(id(self))

    def released(self: Any) -> None:
        release(self)
        assert not self._buffers
        assert not self._arrays
        alive.discard(id(self))

    monkeypatch.setattr(blocks.MeshBlocks, "__init__", made)
    monkeypatch.setattr(blocks.MeshBlocks, "release", released)
    with shown(field(), isovalue=0.4) as (window, handle):
        for isovalue in np.linspace(0.3, 0.8, 12):
            handle.update(isovalue=float(isovalue))
            window.render()
            handle.raise_error()
            assert len(alive) == 1
        for _ in range(5):
            for other in ("raycast", "marching_tetrahedra", "marching_cubes"):
                handle.update(technique=other)
                window.render()
                handle.raise_error()
        assert len(alive) == 1
    assert not alive


def test_blocks_hold_every_triangle_once() -> None:
    class Buffers:
        """Stands for the GPU and keeps what is uploaded."""

        uploads = 0

        def __init__(self) -> None:
            self.gl = self
            self.made: list[Any] = []

        def buffer(self, data: Any) -> Any:
            self.made.append(data.copy())
            return data

    vertices, faces, normals = marching_cubes(np.random.default_rng(1).random((30, 30, 30)), 0.5)
    assert normals is not None
    mesh = ReadyMesh(MeshRequest(field(), 0.5, "lorensen", 1), vertices, faces, normals)
    gpu: Any = Buffers()
    cut = blocks.MeshBlocks(gpu, mesh)
    assert cut.count > 2
    found = []
    for block in range(cut.count):
        cut._uploaded(block)
        packed, indices = gpu.made[-2:]
        found.append(packed[indices.ravel()])
    assert np.array_equal(np.concatenate(found), np.hstack([vertices, normals])[faces.ravel()])
    assert gpu.uploads == cut.count
