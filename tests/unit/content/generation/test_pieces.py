"""Pieces of families for a room: names are completed by seeds that suit each other."""

from __future__ import annotations

from collections import Counter

import pytest

from sailenv_content.families.making import drawn_values
from sailenv_content.families.materials import FABRICS, WOODS, PieceMaterial
from sailenv_content.families.names import parsed
from sailenv_content.families.registry import family_named
from sailenv_content.generation.pieces import PieceChooser, RoomStyle
from sailenv_ros.authoring.room_rules.random_stream import RandomStream

STYLES = ("chair~dining:*", "table~dining:*", "sideboard~buffet:*", "bookcase~tall:*")


def _style(seed: int) -> RoomStyle:
    return RoomStyle.drawn(RandomStream("style", seed))


def test_names_without_a_seed_to_be_drawn_stay_as_they_are() -> None:
    chooser = PieceChooser(RandomStream("test"), _style(0))
    for name in ("chair_01", "chair~dining:17"):
        assert chooser.chosen(name) == name


def test_the_same_numbers_choose_the_same_pieces_and_others_others() -> None:
    def names(seed: int) -> list[str]:
        chooser = PieceChooser(RandomStream("pieces", seed), _style(seed))
        return [chooser.chosen(name) for name in STYLES]

    assert names(3) == names(3)
    assert set(names(3)).isdisjoint(names(4))
    assert all(parsed(name) is not None for name in names(3))


def test_most_are_of_seeds_where_there_are_both() -> None:
    chooser = PieceChooser(RandomStream("share"))
    found = [chooser.one_of(["chair_01", "chair_02", "chair~dining:*"]) for _ in range(400)]
    assert 0.85 < sum(parsed(name) is not None for name in found) / 400 < 0.95
    assert {"chair_01", "chair_02"} < set(found)
    assert chooser.one_of(["chair_01"]) == "chair_01"
    assert parsed(chooser.one_of(["chair~dining:*"])) is not None


def test_the_woods_of_a_room_are_its_own() -> None:
    """At least twice as often as without a style, over many rooms."""
    known = {material.surface.name for material in WOODS}

    def share(styled: bool) -> float:
        found: Counter[bool] = Counter()
        for seed in range(12):
            style = _style(seed)
            chooser = PieceChooser(RandomStream("pieces", seed), style if styled else None)
            for asked in STYLES:
                piece = parsed(chooser.chosen(asked))
                assert piece is not None
                values = drawn_values(family_named(piece.family), piece).all
                for value in values.values():
                    name = value.surface.name if isinstance(value, PieceMaterial) else ""
                    if name in known:
                        found[name in style.woods] += 1
        return found[True] / found.total()

    assert share(styled=True) > 2.0 * share(styled=False)


@pytest.mark.parametrize(
    ("values", "least"),
    [
        ((), 0.0),
        ((WOODS[0],), 1.0),
        ((WOODS[1],), 0.5),
        ((WOODS[2],), -1.0),
        (((WOODS[0], WOODS[2]), 3.0, "shaker"), 0.0),
        ((FABRICS[0], WOODS[0]), 2.0),
    ],
)
def test_fit_is_the_sum_over_materials(values: tuple[object, ...], least: float) -> None:
    style = RoomStyle(
        woods=(WOODS[0].surface.name, WOODS[1].surface.name),
        metal="brass",
        fabrics=(FABRICS[0].surface.name,),
    )
    assert style.fit(values) == least
