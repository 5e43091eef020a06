"""Parts of an answer: steps that the caller carries out, and texts of refusals.

Types alone; knows no socket, no thread, no simulation.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from typing import Any, ParamSpec, TypeAlias

from sailenv_ros.errors import SailenvError
from sailenv_ros.gateway.codec import pack_string
from sailenv_ros.simulation.operations import Operation

__all__ = ["Response", "Request", "Step", "Work", "errors_as_text", "one_line"]

P = ParamSpec("P")

_log = logging.getLogger(__name__)

MAX_WORDS = 1000
"""Longest sentence that a client is told [characters]."""


class Request:
    """An operation of the simulation with its arguments; its result is the operation's.

    Parameters
    ----------
    operation : Operation
    *args, **kwargs
        Of the operation.
    """

    def __init__(self, operation: Operation[P, Any], /, *args: P.args, **kwargs: P.kwargs) -> None:
        self.operation: Operation[..., Any] = operation
        self.args = args
        self.kwargs = kwargs


@dataclass(frozen=True, slots=True)
class Work:
    """Something to compute that takes a while and needs no simulation."""

    function: Callable[[], Any]


Step: TypeAlias = Request | Work

Response: TypeAlias = Generator[Step, Any, Sequence[bytes]]
"""Yields steps, is sent their results or thrown their errors, returns the bytes to send."""


def errors_as_text(asked: Callable[[], Request]) -> Response:
    """Answer ``ok`` when what is asked for is done, else with the sentence of what went wrong.

    Parameters
    ----------
    asked : callable
        Gives the operation; what it raises is told as well.
    """
    try:
        yield asked()
    except SailenvError as error:
        _log.warning("a client's request was refused: %s", one_line(error))
        return [pack_string(one_line(error))]
    return [pack_string("ok")]


def one_line(error: SailenvError) -> str:
    """Return an error's sentences on one line, not endlessly long."""
    text = "; ".join(line.strip() for line in str(error).splitlines() if line.strip())
    return text if len(text) <= MAX_WORDS else text[: MAX_WORDS - 3] + "..."
