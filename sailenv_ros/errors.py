"""All exceptions of the package; each takes typed arguments and builds its own sentence.

Every sentence says what was wrong and what is accepted, with the names that the user wrote.

    SailenvError
    ├── InvalidRequest          an argument that cannot be accepted
    │   ├── UnknownName         a name that is not in a list of names
    │   ├── NameTaken           a name that must be unique is in use
    │   └── InvalidEntry        something described by several values, some of them wrong
    ├── InvalidState            something that is not possible as things are now
    │   └── NoFreeSpace         a place in a scene that was looked for, and is not there
    ├── AddressInUse            a port that another program listens on
    ├── InternalFault           an error of the simulator itself
    ├── SceneError              one or more errors in a scene file, each with file:line:column
    ├── AssetError              a model, texture or pack that cannot be used
    │   └── AssetMissing        a file that is not where it is looked for
    ├── PhysicsError            the physics engine refused a call or diverged
    ├── RenderError             a picture could not be rendered
    │   ├── ContextError        no OpenGL context could be created
    │   └── NativeLibraryError  the native library is missing, or refused its arguments
    ├── SimulationClosed        the simulation has ended, before or during a request
    │   └── WrongProcess        it lives in another process than the one that asks
    ├── DeadlineExceeded        something did not happen in time
    │   └── SimulatorLost       the simulator no longer answers
    ├── ProtocolError           bytes of a client that violate the protocol
    ├── RecordingError          a recording or data set that cannot be written or read
    │   ├── WriteFailed         the disk refused it; once there is room the same call continues
    │   ├── PlaceTaken          something else is where it is to be written
    │   └── BegunOtherwise      it was begun there with other settings
    ├── StorageError            a file that cannot be written, e.g. because the disk is full
    └── MissingPackage          an optional package that is not installed
"""

from __future__ import annotations

import difflib
import errno
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
E = TypeVar("E", bound="SailenvError")


class SailenvError(Exception):
    """Base class of all exceptions that this package raises on purpose."""

    @classmethod
    def from_sentence(cls: type[E], sentence: str) -> E:
        """Return an error of this type that another process has put into words."""
        error = cls.__new__(cls)
        Exception.__init__(error, sentence)
        return error

    def __reduce__(self) -> Any:
        return type(self).from_sentence, (str(self),), self.__dict__


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
        super().__init__(f"{_shortened(what)} must be {accepted}, got {_shown(got)}")


class UnknownName(InvalidRequest):
    """A name of a `kind` of things that is not among the known ones; the nearest is suggested.

    Names of the form `also` says are accepted besides.
    """

    def __init__(self, kind: str, name: str, known: Iterable[str], *, also: str = "") -> None:
        names = [str(k) for k in known]
        near = difflib.get_close_matches(str(name), names, n=1, cutoff=0.6)
        shown = ", ".join(names[:12]) + (f" and {len(names) - 12} more" if len(names) > 12 else "")
        accepted = f"one of: {shown}" if names else f"the name of a {kind}, but there is none"
        if near:
            accepted = f"one of: {shown} (did you mean {near[0]!r}?)"
        if also:
            accepted += f"; or {also}"
        self.kind, self.name = kind, name
        self.known = tuple(names)
        super().__init__(kind, name, accepted)


class NameTaken(InvalidRequest):
    """A name that must be unique is already in use."""

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
    diagnostics : iterable of (str, str)
        The name of each value that is wrong, with what is wrong and what is accepted.
    """

    def __init__(self, what: str, got: object, diagnostics: Iterable[tuple[str, str]]) -> None:
        self.what = what
        self.got = got
        self.diagnostics = tuple(diagnostics)
        self.accepted = "; ".join(
            f"{field} {diagnostic}".strip() for field, diagnostic in self.diagnostics
        )
        SailenvError.__init__(self, f"{_shortened(what)}: {self.accepted}")


class InvalidState(SailenvError):
    """Something that is not possible as things are now, and what would make it so."""


class NoFreeSpace(InvalidState):
    """A place in a scene that was looked for, and is not there; says why."""


class AddressInUse(SailenvError, OSError):
    """A port that another program listens on; `what` wanted to, e.g. ``"the gateway"``."""

    def __init__(self, what: str, host: str, port: int) -> None:
        self.host = host
        self.port = port
        super().__init__(
            f"{what} cannot listen on {host}:{port}: another program does; choose another port"
        )


class InternalFault(SailenvError):
    """An internal error of the simulator; its log says more."""

    @classmethod
    def of(cls, error: Exception) -> InternalFault:
        """Return what a client is told of an exception that was not expected."""
        what = f"{type(error).__name__}: {error}"
        return cls(f"an internal error of the simulator, see its log: {what}")


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneDiagnostic:
    """One error of a scene file.

    Attributes
    ----------
    path : str
        The file as its user named it.
    line, column : int
        Where the error stands, counted from 1; 0 where it has no place in the text.
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
        return ": ".join((place, *filter(None, [self.field]), self.message))


class SceneError(SailenvError):
    """A scene file with errors: all of them, in the order of the file."""

    def __init__(self, diagnostics: Iterable[SceneDiagnostic]) -> None:
        self.diagnostics = tuple(diagnostics)
        super().__init__("\n".join(str(diagnostic) for diagnostic in self.diagnostics))


class AssetError(SailenvError):
    """A model, texture or pack that cannot be used."""

    def __init__(self, asset: str, why: str) -> None:
        self.asset, self.why = asset, why
        super().__init__(f"asset {asset!r}: {why}")


class AssetMissing(AssetError):
    """A file of a model or robot that is not where it is looked for."""


class PhysicsError(SailenvError):
    """The physics engine refused a call, or a body's state is no longer finite."""


class RenderError(SailenvError):
    """A picture could not be rendered."""


class ContextError(RenderError):
    """No OpenGL context could be created; `attempts` says why, one line for each device tried."""

    def __init__(self, attempts: Iterable[str]) -> None:
        self.attempts = tuple(attempts)
        tried = "; ".join(self.attempts) or "nothing was tried"
        super().__init__(f"no OpenGL context could be created ({tried})")


class NativeLibraryError(RenderError):
    """The native library cannot be used; `reason` says why."""

    def __init__(self, reason: str) -> None:
        self.reason = reason
        super().__init__(
            f"the native library cannot be used: {reason}; "
            "scripts/build-native makes it anew, and so does installing the package where there "
            "is a C++ compiler"
        )


class SimulationClosed(SailenvError):
    """The simulation has ended, before or during a request."""

    def __init__(self, why: str = "it was closed") -> None:
        self.why = why
        super().__init__(f"the simulation has ended: {why}")


class WrongProcess(SimulationClosed):
    """A `thing` that works in the process `made_in` alone, in a fork of it or on the way out."""

    def __init__(self, thing: str, *, made_in: int) -> None:
        self.why = f"process {made_in} has made it"
        SailenvError.__init__(
            self,
            f"this {thing} works in the process that made it alone ({made_in}) and cannot be "
            "copied, sent to another one or inherited by a fork: make it in the worker",
        )


class DeadlineExceeded(SailenvError, TimeoutError):
    """Something did not happen in time: `waited_for`, in words, within `timeout_s` seconds."""

    def __init__(self, waited_for: str, timeout_s: float) -> None:
        self.waited_for, self.timeout_s = waited_for, timeout_s
        super().__init__(f"timed out after {timeout_s:g} s while waiting for {waited_for}")


class SimulatorLost(DeadlineExceeded):
    """A simulator that answered before no longer answers; noticed after `waited_s` seconds."""

    def __init__(self, waited_for: str, waited_s: float) -> None:
        super().__init__(waited_for, waited_s)
        self.args = (f"the simulator has ended; {waited_for} did not come ({waited_s:.3g} s)",)


class ProtocolError(SailenvError):
    """Bytes of a client that violate the protocol."""


class RecordingError(SailenvError):
    """A recording or a data set that cannot be written or read."""


class WriteFailed(RecordingError):
    """A file that the disk or a remote place refuses; once it does not, the same call continues."""

    def __init__(self, path: object, problem: Exception) -> None:
        self.path = str(path)
        self.errno = getattr(problem, "errno", None)
        why = getattr(problem, "strerror", None) or str(problem)
        super().__init__(f"{self.path} cannot be written: {why}")


class PlaceTaken(RecordingError):
    """A place where something else is; it was left as it is."""

    def __init__(self, place: str, why: str = "is not empty") -> None:
        self.place = place
        super().__init__(f"{place} {why}; nothing is overwritten, choose another place")


class BegunOtherwise(RecordingError):
    """A place where the same kind of work was begun with other settings.

    Parameters
    ----------
    place : str
    differing : mapping of str to (object, object)
        The settings that differ: as they are there, and as they were asked for. None is unset.
    """

    def __init__(self, place: str, differing: Mapping[str, tuple[object, object]]) -> None:
        self.place = place
        self.differing = dict(differing)
        told = [
            f"{name} is {_shown(known)}, not {_shown(wanted)}"
            for name, (known, wanted) in list(self.differing.items())[:3]
        ]
        if len(self.differing) > len(told):
            told.append(f"and {len(self.differing) - len(told)} more")
        super().__init__(
            f"{place} was begun otherwise: {', '.join(told)}; choose another place, or repeat "
            "its settings"
        )


class StorageError(SailenvError):
    """A file of ours that cannot be written, e.g. ``"the baked light"``; the old one is there."""

    def __init__(self, what: str, path: str, problem: OSError) -> None:
        self.what = what
        self.path = path
        self.errno = problem.errno
        why = "the disk is full" if problem.errno in _FULL else problem.strerror or str(problem)
        super().__init__(f"{what} cannot be written to {path}: {why}")


class MissingPackage(SailenvError, ImportError):
    """An optional package that `purpose` needs is not installed; `command` installs it."""

    def __init__(self, purpose: str, package: str, command: str) -> None:
        self.purpose = purpose
        self.package = package
        self.command = command
        super().__init__(f"{purpose} needs {package}, which is not installed: {command}")


def _shown(value: object) -> str:
    """Show a value on one short line, whatever it is."""
    return _shortened(" ".join(repr(value).split()), 80)


def _shortened(text: str, most: int = 200) -> str:
    return text if len(text) <= most else text[: most - 3] + "..."
