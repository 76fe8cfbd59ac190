"""Names of techniques, settings, presets and samples reach the translator."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from PySide6.QtCore import QCoreApplication, QTranslator
from PySide6.QtWidgets import QComboBox, QLabel

from volviz_ui.app.main_window import MainWindow
from volviz_ui.library_words import CONTEXT


class Marking(QTranslator):
    """Puts what the library says into quotation marks."""

    def translate(self, context: str, text: str, _disambiguation: str = "", _n: int = -1) -> str:  # type: ignore[override]
        return f"«{text}»" if context == CONTEXT else ""

    def isEmpty(self) -> bool:
        return False


@pytest.fixture
def marking() -> Iterator[None]:
    translator = Marking()
    QCoreApplication.installTranslator(translator)
    yield
    QCoreApplication.removeTranslator(translator)


@pytest.mark.usefixtures("marking")
def test_what_the_library_says_is_translated(bare_window: MainWindow, ball_file: str, wait_for) -> None:
    bare_window.open(ball_file)
    wait_for(lambda: bare_window.documents.volume is not None)
    panel = bare_window.technique_panel
    box = panel.findChildren(QComboBox)[0]
    assert all(box.itemText(n).startswith("«") for n in range(box.count()))
    wait_for(lambda: panel.form is not None and panel.form.is_whole)
    labels = [words.text() for words, _reset in panel.form._rows.values()]
    assert labels
    assert all(label.startswith("«") for label in labels)
    assert all(group.startswith("«") for group in panel.form.sections if group != "How it works")
    assert isinstance(panel.summary, QLabel)
    assert panel.summary.text().startswith("«")
    popup = bare_window.transfer_editor.popup
    popup.fill()
    assert all(popup.list.item(n).text().startswith("«") for n in range(popup.list.count()))
    shown = {command.id: command for _path, command in bare_window.commands.walk()}
    for start in ("technique.use.", "preset.", "file.sample."):
        found = [c.words(bare_window.commands.state) for ident, c in shown.items() if ident.startswith(start)]
        assert found
        assert all("«" in words for words in found), start
