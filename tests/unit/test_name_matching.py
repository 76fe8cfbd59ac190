"""Finding commands by a few letters of their names."""

from __future__ import annotations

from volviz_ui.commands.fuzzy import match_score


def best(wanted: str, *names: str) -> list[str]:
    """The names that fit, the best one first."""
    scored = [(score, name) for name in names if (score := match_score(wanted, name)) is not None]
    return [name for _score, name in sorted(scored, key=lambda pair: -pair[0])]


def test_nothing_typed_fits_everything_alike() -> None:
    assert match_score("", "Open…") == match_score("  ", "Quit") == 0.0


def test_the_start_of_a_word_counts_more_than_its_middle() -> None:
    assert best("port", "Export picture", "Portrait", "Quit") == ["Portrait", "Export picture"]
    assert best("pic", "Topic", "Export picture") == ["Export picture", "Topic"]


def test_first_letters_of_words_find_a_name() -> None:
    assert best("mc", "Reset camera", "Marching cubes", "Quit")[0] == "Marching cubes"
    assert best("epf", "Export picture") == []


def test_letters_in_their_order_find_a_name_and_near_ones_are_better() -> None:
    assert match_score("xpt", "Export") is not None
    assert match_score("tpx", "Export") is None
    near, far = match_score("qt", "Quit"), match_score("qt", "Quick and dirty")
    assert near is not None
    assert far is not None
    assert near > far


def test_every_word_must_occur_in_any_order_and_case_does_not_matter() -> None:
    assert match_score("PICTURE exp", "Export picture…") is not None
    assert match_score("picture mesh", "Export picture…") is None
