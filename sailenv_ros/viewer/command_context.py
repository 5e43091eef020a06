"""What a command is, and what it needs of the conversation that it came in."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import Any, ParamSpec, Protocol, TypeVar

from sailenv_ros.frame import Frame
from sailenv_ros.operations import Operation
from sailenv_ros.scene_info import SceneInfo
from sailenv_ros.viewer.debug_agent import DebugAgent
from sailenv_ros.viewer.edit_history import EditHistory
from sailenv_ros.viewer.request_arguments import Arguments

__all__ = ["Command", "CommandTable", "CommandContext"]


P = ParamSpec("P")
R = TypeVar("R")


class CommandContext(Protocol):
    """What a command needs of the conversation that it came in."""

    debug_agent: DebugAgent
    history: EditHistory
    picture_pieces: bytearray

    @property
    def info(self) -> SceneInfo:
        """The scene as it was announced last."""

    def frame(self, number: object) -> Frame:
        """Return a frame that this client was sent lately; None means the last one."""

    def select(self, instance_id: int) -> None:
        """Have an instance's outline told; 0 for none."""

    async def run(self, operation: Operation[P, R], /, *args: P.args, **kwargs: P.kwargs) -> R:
        """Have the simulation do something; wait for its result."""


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
    """

    run: Run
    changes: bool


class CommandTable(dict[str, Command]):
    """Commands by their names; its two methods decorate what they are done by."""

    def looks(self, run: Run) -> Run:
        """Take a command up that changes nothing."""
        self[run.__name__] = Command(run=run, changes=False)
        return run

    def changes(self, run: Run) -> Run:
        """Take a command up that those who only watch may not give."""
        self[run.__name__] = Command(run=run, changes=True)
        return run
