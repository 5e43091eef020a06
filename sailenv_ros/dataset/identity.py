"""Identity of a job: the settings that decide on every byte, kept in a file where it grows."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from sailenv_ros.dataset.storage import Storage
from sailenv_ros.errors import BegunOtherwise, PlaceTaken

__all__ = ["WorkIdentity"]


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkIdentity:
    """The identity of a work that is written to a place.

    Attributes
    ----------
    file : str
        Where it is kept, in the place.
    settings : mapping
        JSON; all of them must be equal for the work to be gone on with.
    document : bytes or None
        The content of the file, if it holds more than the settings.
    key : str
        Entry of the document that holds the settings; empty if it is nothing else.
    """

    file: str
    settings: Mapping[str, Any]
    document: bytes | None = None
    key: str = ""

    def to_bytes(self) -> bytes:
        """Return the content of its file."""
        if self.document is not None:
            return self.document
        return (json.dumps(self.settings, indent=2) + "\n").encode()

    def is_begun(self, storage: Storage) -> bool:
        """Return whether this work was begun at a place.

        Raises
        ------
        BegunOtherwise
            If it was begun with other settings.
        PlaceTaken
            If the file of the identity is something else.
        """
        data = storage.read(self.file)
        if data is None:
            return False
        try:
            known = json.loads(data)
            known = known[self.key] if self.key else known
        except (ValueError, KeyError, TypeError, RecursionError):
            known = None
        if not isinstance(known, dict):
            raise PlaceTaken(storage.shown, f"has a {self.file} of something else")
        wanted = json.loads(json.dumps(self.settings))
        differing = {
            name: values
            for key, value in wanted.items()
            for name, values in _differences(key, known.get(key), value)
        }
        if differing:
            raise BegunOtherwise(storage.shown, differing)
        return True


def _differences(name: str, known: Any, wanted: Any) -> Iterator[tuple[str, tuple[Any, Any]]]:
    """Yield each setting that differs, by its path; lists of entries are compared one by one."""
    if isinstance(known, dict) and isinstance(wanted, dict):
        for key in dict.fromkeys((*wanted, *known)):
            yield from _differences(f"{name}.{key}", known.get(key), wanted.get(key))
    elif _entries(known) and _entries(wanted) and len(known) == len(wanted):
        for index, (one, other) in enumerate(zip(known, wanted, strict=True)):
            yield from _differences(f"{name}[{index}]", one, other)
    elif known != wanted:
        yield name, (known, wanted)


def _entries(value: Any) -> bool:
    return isinstance(value, list) and all(isinstance(one, dict) for one in value)
