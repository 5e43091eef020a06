"""What an answer is made of: steps that somebody else carries out, and words for refusals.

Types alone; knows no socket, no thread, no simulation.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Generator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeAlias

from sailenv_ros.errors import SailenvError
from sailenv_ros.gateway.codec import pack_string

__all__ = ["Answer", "Ask", "Step", "Work", "in_words", "one_line"]

_log = logging.getLogger(__name__)

MAX_WORDS = 1000
"""Longest sentence that a client is told [characters]."""


@dataclass(frozen=True, slots=True)
class Ask:
    """A request to the simulation by its name; its result is what the request gives."""

    name: str
    args: tuple[Any, ...] = ()
    kwargs: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Work:
    """Something to compute that takes a while and needs no simulation."""

    function: Callable[[], Any]


Step: TypeAlias = Ask | Work

Answer: TypeAlias = Generator[Step, Any, Sequence[bytes]]
"""Yields steps, is sent their results or thrown their errors, returns the bytes to send."""


def in_words(asking: Generator[Step, Any, object]) -> Answer:
    """Answer ``ok`` when all is done, else with the sentence of what went wrong."""
    try:
        yield from asking
    except SailenvError as error:
        _log.warning("a client's request was refused: %s", one_line(error))
        return [pack_string(one_line(error))]
    return [pack_string("ok")]


def one_line(error: SailenvError) -> str:
    """Give an error's sentences on one line, not endlessly long."""
    text = "; ".join(line.strip() for line in str(error).splitlines() if line.strip())
    return text if len(text) <= MAX_WORDS else text[: MAX_WORDS - 3] + "..."
