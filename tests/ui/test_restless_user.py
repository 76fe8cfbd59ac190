"""One thing after another with mouse and keys: whatever was done, every view shows what the scene says."""

from __future__ import annotations

from pathlib import Path

from tests.ui.restless_user import RestlessUser
from volviz_ui.app.main_window import MainWindow

STEPS = 16
SEED = 7


def test_after_whatever_a_user_does_all_views_show_what_the_scene_says(
    bare_window: MainWindow, tmp_path: Path
) -> None:
    bare_window.resize(900, 640)
    user = RestlessUser(bare_window, tmp_path, SEED)
    bare_window.open(user.files[1])
    user.rest()
    bare_window.commands["compare.split"].trigger()
    for _ in range(STEPS):
        user.step()
    user.rest()
    user.look()
