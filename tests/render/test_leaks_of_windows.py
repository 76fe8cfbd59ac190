"""The leak checks find VTK windows and GL objects that a test leaves behind."""

from __future__ import annotations

import pytest
import pyvista

from tests import leaks

pytestmark = pytest.mark.leaks_allowed("these tests look after their own leaks")


def test_a_plotter_that_is_not_closed_is_found() -> None:
    watch = leaks.Watch(objects=True)
    plotter = pyvista.Plotter(off_screen=True)
    plotter.add_mesh(pyvista.Sphere())
    plotter.screenshot(return_img=True)
    found = "\n".join(watch.leaks())
    assert "RenderWindow is still alive" in found
    assert "Renderer is still alive" in found
    plotter.close()
    del plotter
    assert watch.leaks() == []


def test_a_texture_that_is_not_released_is_found() -> None:
    import moderngl
    from vtkmodules.vtkRenderingCore import vtkRenderWindow

    watch = leaks.Watch(objects=True)
    window = vtkRenderWindow()
    window.SetOffScreenRendering(True)
    window.Render()
    window.MakeCurrent()
    moderngl.init_context()
    texture = moderngl.get_context().texture((4, 4), 4)
    assert "Texture" in "\n".join(watch.leaks())
    texture.release()
    window.Finalize()
    del window, texture
    assert watch.leaks() == []
