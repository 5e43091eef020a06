"""The source of people for the `AssetLibrary`: a name in, a person out, kept while in use."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Mapping
from types import MappingProxyType

from sailenv_content.people.fetch_bodies import BODIES_COMMAND, body_data
from sailenv_content.people.looks import people
from sailenv_ros.errors import AssetError, UnknownName
from sailenv_ros.types.model import Asset

__all__ = ["IN_PARTS", "PeopleSource"]

IN_PARTS = "_in_parts"
"""Ends the name of a person whose hair and clothes have labels of their own."""

PREFIX = "person_"

MAX_KEPT = 64
"""Most people that are kept; the one that was not asked for for longest is dropped first."""

_made: OrderedDict[str, Asset] = OrderedDict()
_lock = threading.Lock()


class PeopleSource:
    """People by their names, ``person_01`` and ``person_01_in_parts``; none without the data."""

    @property
    def display_names(self) -> Mapping[str, str]:
        """Nothing: who looks through a catalogue would have to make them all."""
        return MappingProxyType({})

    def speaks_of(self, name: str) -> bool:
        """Return whether a name is meant to be one of a person."""
        return name.startswith(PREFIX)

    def problem(self, name: str) -> UnknownName | None:
        """Return why there is no person of a name; None if there is one."""
        whole = name.removesuffix(IN_PARTS)
        return None if whole in people() else UnknownName("person", whole, people())

    def sibling(self, name: str, seed: int) -> str | None:
        """Return nothing: a person is nobody else."""
        return None

    def load(self, name: str) -> Asset:
        """Make a person.

        Raises
        ------
        UnknownName
            If there is nobody of that name.
        AssetError
            If the data of bodies is not here, or cannot be read.
        """
        problem = self.problem(name)
        if problem is not None:
            raise problem
        data = body_data()
        if data is None:
            raise AssetError(name, f"the data of bodies is not here; fetch it: {BODIES_COMMAND}")
        from sailenv_content.people.making import make_person  # imports SciPy

        whole = name.removesuffix(IN_PARTS)
        with _lock:
            found = _made.get(name)
            if found is None:
                found = make_person(name, people()[whole], data, labelled=name != whole)
                _made[name] = found
                while len(_made) > MAX_KEPT:
                    _made.popitem(last=False)
            _made.move_to_end(name)
            return found
