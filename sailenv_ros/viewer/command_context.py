"""Commands of the viewer's socket, and what they need of the conversation that they came in."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import Any, Protocol

from sailenv_ros.frame.frame import Frame
from sailenv_ros.viewer.data_set_captures import DataSetCaptures
from sailenv_ros.viewer.debug_agent import DebugAgent
from sailenv_ros.viewer.edit_history import Conversation, EditHistory
from sailenv_ros.viewer.request_arguments import Arguments

__all__ = ["Command", "CommandContext", "CommandTable", "Run"]


class CommandContext(Conversation, Protocol):
    """The conversation that a command came in."""

    captures: DataSetCaptures
    debug_agent: DebugAgent
    history: EditHistory
    picture_pieces: bytearray

    def frame(self, number: object) -> Frame:
        """Return a frame that this client was sent lately; None means the last one."""

    def select(self, instance_id: int) -> None:
        """Subscribe to the outline of an instance; 0 to stop."""


Run = Callable[[CommandContext, Arguments], Awaitable[Any]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Command:
    """One command.

    Attributes
    ----------
    run : callable
        Gives what is answered, in plain values for JSON.
    changes : bool
        True if it changes anything: those who only watch may not.
    is_operation : bool
        True if the operation of the same name declares values and answer; else `run` does.
    answer : type or None
        Type of the answer where it is another than the operation's result.
    """

    run: Run
    changes: bool
    is_operation: bool = False
    answer: Any = None


class CommandTable(dict[str, Command]):
    """Commands by their names; its two methods decorate what they are done by."""

    def looks(self, run: Run) -> Run:
        """Take a command up that changes nothing."""
        self[run.__name__] = Command(run=run, changes=False)
        return run

    def changes(self, run: Run) -> Run:
        """Register a command that needs write access."""
        self[run.__name__] = Command(run=run, changes=True)
        return run
