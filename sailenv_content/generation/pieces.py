"""Pieces of families for a room: seeds whose woods, metals and fabrics go together.

Names of a rule file in, names of assets out: ``chair~dining:*`` → ``chair~dining:5127``.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from sailenv_content.families.making import drawn_values
from sailenv_content.families.materials import (
    FABRICS,
    METAL_NAMES,
    WOODS,
    PieceMaterial,
    metal,
)
from sailenv_content.families.names import PieceName, parsed
from sailenv_content.families.registry import family_named
from sailenv_ros.authoring.room_rules.random_stream import RandomStream
from sailenv_ros.authoring.room_rules.rule_files import ANY_SEED

__all__ = ["PieceChooser", "RoomStyle"]

SEEDS = (0, 99_999)
"""Seeds that a room draws, both included."""

DRAWS = 12
"""Seeds that are compared, for the one that suits the room best."""

SEEDED = 0.9
"""Share of pieces by seeds where a rule names objects of the catalogue too."""

_METALS = tuple(metal(name).surface.name for name in ("chrome", "steel", "brass", "#26272a"))
_METAL_WEIGHT = 0.5


@dataclass(frozen=True, slots=True)
class RoomStyle:
    """Names of the materials that furniture of a room should share.

    Attributes
    ----------
    woods : tuple of str
        The first suits best.
    metal : str
    fabrics : tuple of str
    """

    woods: tuple[str, ...]
    metal: str
    fabrics: tuple[str, ...]

    @classmethod
    def drawn(cls, dice: RandomStream) -> RoomStyle:
        """Draw the style of a room."""
        woods = dice.mixed([material.surface.name for material in WOODS])
        fabrics = dice.mixed([material.surface.name for material in FABRICS])
        return cls(tuple(woods[:2]), dice.one(_METALS), tuple(fabrics[:3]))

    def fit(self, values: Iterable[Any]) -> float:
        """Return how well drawn values suit the room; the larger, the better."""
        names = [material.surface.name for material in _materials(values)]
        woods = [name for name in names if name in _WOOD_NAMES]
        metals = [name for name in names if name in METAL_NAMES or name.startswith("coated ")]
        fabrics = [name for name in names if name in _FABRIC_NAMES]
        score = sum(_rank(name, self.woods) for name in woods)
        score += _METAL_WEIGHT * sum(_rank(name, (self.metal,)) for name in metals)
        return score + sum(_rank(name, self.fabrics) for name in fabrics)


_WOOD_NAMES = frozenset(material.surface.name for material in WOODS)
_FABRIC_NAMES = frozenset(material.surface.name for material in FABRICS)


class PieceChooser:
    """Completes names of pieces with seeds.

    Parameters
    ----------
    dice : RandomStream
    style : RoomStyle or None
        None takes the first seed that is drawn.
    """

    def __init__(self, dice: RandomStream, style: RoomStyle | None = None) -> None:
        self._dice, self._style = dice, style

    @property
    def style(self) -> RoomStyle | None:
        """The style that pieces are chosen to suit."""
        return self._style

    def one_of(self, names: Sequence[str]) -> str:
        """Return an asset of several names, most often one of a seed: the others are few."""
        seeded = [name for name in names if name.endswith(ANY_SEED)]
        listed = [name for name in names if not name.endswith(ANY_SEED)]
        some = seeded if seeded and (not listed or self._dice.chance(SEEDED)) else listed
        return self.chosen(self._dice.one(some))

    def chosen(self, name: str) -> str:
        """Return the name of an asset, which has no seed left to be drawn."""
        if not name.endswith(ANY_SEED):
            return name
        stem = name.removesuffix(ANY_SEED)
        names = [f"{stem}:{self._dice.whole(SEEDS)}" for _ in range(DRAWS if self._style else 1)]
        return names[0] if self._style is None else max(names, key=self._fit)

    def _fit(self, name: str) -> float:
        assert self._style is not None
        piece = parsed(name)
        assert isinstance(piece, PieceName)  # as rules are checked
        return self._style.fit(drawn_values(family_named(piece.family), piece).all.values())


def _materials(values: Iterable[Any]) -> Iterator[PieceMaterial]:
    for value in values:
        if isinstance(value, PieceMaterial):
            yield value
        elif isinstance(value, tuple):
            yield from _materials(value)


def _rank(name: str, wanted: tuple[str, ...]) -> float:
    """Return 1 for the first of those wanted, less for the others, and -1 for what is not."""
    return 1.0 / (1 + wanted.index(name)) if name in wanted else -1.0
