"""Table of generated rooms: for training, for validation, and for tests.

The one table of their seeds. A room's number and the kinds in use give its name, which any process
makes the same room of.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

from sailenv_ros.authoring.room_rules.names import PREFIX
from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.types.validation import Bounds

__all__ = ["KINDS", "SPLITS", "room_names"]

SPLITS: Mapping[str, range] = MappingProxyType(
    {"train": range(80_000), "val": range(80_000, 90_000), "test": range(90_000, 100_000)}
)
"""Seeds of the rooms of each split; no seed is in two of them."""

KINDS = ("living_room", "bedroom", "kitchen", "office")
"""Kinds of generated rooms that environments take unless told otherwise, in turn."""

_COUNT = Bounds(least=1, most=10_000, whole=True)


def room_names(
    rooms: int | Sequence[str], *, split: str = "train", kinds: Sequence[str] = KINDS
) -> tuple[str, ...]:
    """Return the names of an environment's rooms.

    Parameters
    ----------
    rooms : int or sequence of str
        How many of the split, 1 to 10,000; or names of scenes, whatever the split.
    split : {'train', 'val', 'test'}
    kinds : sequence of str
        Of generated rooms; room k of a split is of kind k, in turn, and of its k-th seed.

    Raises
    ------
    UnknownName, InvalidRequest
        If there is no such split, or no room.
    """
    if split not in SPLITS:
        raise UnknownName("split", str(split), SPLITS)
    if isinstance(rooms, str):
        rooms = (rooms,)
    if not isinstance(rooms, int):
        names = tuple(rooms)
        if not names or not all(isinstance(name, str) and name for name in names):
            raise InvalidRequest("rooms", rooms, "a number of rooms, or names of scenes")
        return names
    if isinstance(kinds, str) or not kinds:
        raise InvalidRequest("kinds", kinds, "at least one kind of generated rooms, in a list")
    count = _COUNT.integer("rooms", rooms)
    seeds = SPLITS[split]
    return tuple(f"{PREFIX}{kinds[number % len(kinds)]}:{seeds[number]}" for number in range(count))
