"""The one tree of errors; each takes typed arguments and builds its own sentence.

Every sentence says what was wrong and what would be accepted, in the user's own names.

    SailenvError
    ├── InvalidRequest          an argument that cannot be accepted
    │   ├── UnknownName         a name that is not in a list of names
    │   ├── NameTaken           a name that must be unique is in use
    │   └── InvalidEntry        something described by several values, some of them wrong
    ├── SceneError              one or more faults in a scene file, each with file:line:column
    ├── AssetError              a model, texture or pack that cannot be used
    ├── PhysicsError            the physics engine refused or diverged
    ├── RenderError             a picture could not be made
    │   └── ContextError        no OpenGL context could be created
    ├── SimulationClosed        the simulation has ended, or ended while it was asked
    ├── DeadlineExceeded        something did not happen in time
    │   └── SimulatorLost       a simulator that answered before does so no more
    ├── RequestRefused          the simulator refused a request, in its own words
    ├── ProtocolError           bytes of a peer that break the protocol
    ├── RecordingError          a recording that cannot be written or read
    └── MissingPackage          an optional package that is not installed
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from dataclasses import dataclass

__all__ = [
    "AssetError",
    "ContextError",
    "DeadlineExceeded",
    "InvalidEntry",
    "InvalidRequest",
    "MissingPackage",
    "NameTaken",
    "PhysicsError",
    "ProtocolError",
    "RecordingError",
    "RenderError",
    "RequestRefused",
    "SailenvError",
    "SceneError",
    "SceneFault",
    "SimulationClosed",
    "SimulatorLost",
    "UnknownName",
]


class SailenvError(Exception):
    """Root of every error that this package raises on purpose."""


class InvalidRequest(SailenvError, ValueError):
    """An argument that cannot be accepted; nothing was changed.

    Parameters
    ----------
    what : str
        The argument's name as its user wrote it, e.g. ``"width"``.
    got : object
        The value that was given.
    accepted : str
        What would be accepted, e.g. ``"an integer from 16 to 4096 [px]"``.
    """

    def __init__(self, what: str, got: object, accepted: str) -> None:
        self.what = what
        self.got = got
        self.accepted = accepted
        super().__init__(f"{what} must be {accepted}, got {_shown(got)}")


class UnknownName(InvalidRequest):
    """A name that is not among the known ones; the nearest known name is suggested.

    Parameters
    ----------
    kind : str
        What is named, e.g. ``"scene"``.
    name : str
        The unknown name.
    known : iterable of str
        The names that would have been accepted.
    """

    def __init__(self, kind: str, name: str, known: Iterable[str]) -> None:
        names = [str(k) for k in known]
        near = difflib.get_close_matches(str(name), names, n=1, cutoff=0.6)
        shown = ", ".join(names[:12]) + (f" and {len(names) - 12} more" if len(names) > 12 else "")
        accepted = f"one of: {shown}" if names else f"the name of a {kind}, and there is none"
        if near:
            accepted = f"one of: {shown} (did you mean {near[0]!r}?)"
        self.kind = kind
        self.name = name
        self.known = tuple(names)
        super().__init__(kind, name, accepted)


class NameTaken(InvalidRequest):
    """A name that must be unique is in use already."""

    def __init__(self, kind: str, name: str) -> None:
        self.kind = kind
        self.name = name
        super().__init__(f"{kind} name", name, "a name that is not in use yet")


class InvalidEntry(InvalidRequest):
    """Something described by several values of which some cannot be accepted.

    Parameters
    ----------
    what : str
        What was described, e.g. ``"object 'chair_1'"``.
    got : object
        The description.
    faults : iterable of (str, str)
        The name of each value that is wrong, with what is wrong and what is accepted.
    """

    def __init__(self, what: str, got: object, faults: Iterable[tuple[str, str]]) -> None:
        self.what = what
        self.got = got
        self.faults = tuple(faults)
        self.accepted = "; ".join(f"{field} {fault}".strip() for field, fault in self.faults)
        SailenvError.__init__(self, f"{what}: {self.accepted}")


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneFault:
    """One fault of a scene file.

    Attributes
    ----------
    path : str
        The file as its user named it.
    line, column : int
        Where the fault stands, counted from 1; 0 where it has no place in the text.
    field : str
        The dotted path of the entry, e.g. ``"objects[2].mass"``.
    message : str
        What was wrong and what is accepted.
    """

    path: str
    line: int
    column: int
    field: str
    message: str

    def __str__(self) -> str:
        place = f"{self.path}:{self.line}:{self.column}" if self.line else self.path
        return (
            f"{place}: {self.field}: {self.message}" if self.field else f"{place}: {self.message}"
        )


class SceneError(SailenvError):
    """A scene file with faults: all of them, in the order of the file."""

    def __init__(self, faults: Iterable[SceneFault]) -> None:
        self.faults = tuple(faults)
        super().__init__("\n".join(str(fault) for fault in self.faults))


class AssetError(SailenvError):
    """A model, texture or pack that cannot be used."""

    def __init__(self, asset: str, why: str) -> None:
        self.asset = asset
        self.why = why
        super().__init__(f"asset {asset!r}: {why}")


class PhysicsError(SailenvError):
    """The physics engine refused a call, or a body's state is no longer finite."""


class RenderError(SailenvError):
    """A picture could not be made."""


class ContextError(RenderError):
    """No OpenGL context could be created.

    Parameters
    ----------
    attempts : iterable of str
        One line for each device or backend tried, with the reason it was refused.
    """

    def __init__(self, attempts: Iterable[str]) -> None:
        self.attempts = tuple(attempts)
        tried = "; ".join(self.attempts) or "nothing was tried"
        super().__init__(f"no OpenGL context could be created ({tried})")


class SimulationClosed(SailenvError):
    """The simulation has ended, or ended while it was asked something."""

    def __init__(self, why: str = "it was closed") -> None:
        self.why = why
        super().__init__(f"the simulation has ended: {why}")


class DeadlineExceeded(SailenvError, TimeoutError):
    """Something did not happen in time.

    Parameters
    ----------
    waited_for : str
        What was waited for, e.g. ``"the service /sailenv/register_agent"``.
    timeout_s : float
        How long [s].
    """

    def __init__(self, waited_for: str, timeout_s: float) -> None:
        self.waited_for = waited_for
        self.timeout_s = timeout_s
        super().__init__(f"waited {timeout_s:g} s for {waited_for}, in vain")


class SimulatorLost(DeadlineExceeded):
    """A simulator that answered before does so no more."""


class RequestRefused(SailenvError):
    """The simulator refused a request; its sentence says why and what it would accept."""

    def __init__(self, request: str, message: str) -> None:
        self.request = request
        self.message = message
        super().__init__(f"{request}: {message}")


class ProtocolError(SailenvError):
    """Bytes of a peer that break the protocol."""


class RecordingError(SailenvError):
    """A recording that cannot be written or read."""


class MissingPackage(SailenvError, ImportError):
    """An optional package that something needs is not installed.

    Parameters
    ----------
    purpose : str
        What needs it, e.g. ``"a plot"``.
    package : str
    command : str
        What installs it.
    """

    def __init__(self, purpose: str, package: str, command: str) -> None:
        self.purpose = purpose
        self.package = package
        self.command = command
        super().__init__(f"{purpose} needs {package}, which is not installed: {command}")


def _shown(value: object) -> str:
    """Show a value on one short line, whatever it is."""
    text = " ".join(repr(value).split())
    return text if len(text) <= 80 else text[:77] + "..."
