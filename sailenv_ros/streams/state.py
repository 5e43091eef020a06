"""The state of a stream's world that drifts, and what is recorded of each drift.

Numbers of frames in, values out: a state depends on the number of the frame alone, so that any
frame can be made without those before it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol, TypeAlias

__all__ = ["Drift", "DriftRecord", "DriftValue", "StreamState", "progress", "tinted"]

DriftValue: TypeAlias = float | tuple[float, ...] | tuple[str, ...]

Colour: TypeAlias = tuple[float, float, float]
"""Factors of red, green and blue, linear."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DriftRecord:
    """Effect of a drift on one frame.

    Attributes
    ----------
    values : mapping of str to float or tuple
        By the drift's own names.
    since : int
        Number of the first frame of what lasts: of a change that stays, or of the whole drift.
        A drift that has not begun has the number at which it will.
    active : bool
        False before its onset.
    """

    values: Mapping[str, DriftValue]
    since: int
    active: bool

    def to_json(self) -> dict[str, Any]:
        """Return it as recordings tell it."""
        return {"values": dict(self.values), "since": self.since, "active": self.active}


@dataclass(slots=True, kw_only=True)
class StreamState:
    """State that all drifts together make of the world; each changes what it is about.

    Attributes
    ----------
    daylight, lamplight : float
        Factors of the power of windows and sun, and of lamps.
    daylight_colour, lamp_colour : (3,) tuple of float
        Factors of their colours.
    picture : dict of str to float
        Settings of the picture that differ from the course's; see `PictureSettings`.
    zoom : float
        Factor of the focal length.
    mount_rpy_deg : (3,) tuple of float
        How the camera is turned on what carries it [deg].
    mount_m : (3,) tuple of float
        How it is shifted there: forward, left, up [m].
    paint : (3,) tuple of float, or None
        Colour of all walls, linear; None for the room's own.
    worn : float
        From 0, as new, to 1: how far furniture has yellowed.
    furniture_lives : float
        How often each piece of furniture has been replaced, on average.
    absent : set of str
        Categories of which nothing is there.
    """

    daylight: float = 1.0
    daylight_colour: Colour = (1.0, 1.0, 1.0)
    lamplight: float = 1.0
    lamp_colour: Colour = (1.0, 1.0, 1.0)
    picture: dict[str, float] = field(default_factory=dict)
    zoom: float = 1.0
    mount_rpy_deg: tuple[float, float, float] = (0.0, 0.0, 0.0)
    mount_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    paint: Colour | None = None
    worn: float = 0.0
    furniture_lives: float = 0.0
    absent: set[str] = field(default_factory=set)


class Drift(Protocol):
    """One way in which the world changes over the numbers of frames."""

    def apply(self, state: StreamState, frame: int, seed: int) -> DriftRecord:
        """Change a state to what it is at a frame, and return what was done.

        Parameters
        ----------
        state : StreamState
        frame : int
        seed : int
            Of the stream; the only source of chance.
        """


def tinted(colour: Colour, share: float) -> Colour:
    """Return factors between none, at a share of 0, and a colour, at 1."""
    red, green, blue = (1.0 + share * (part - 1.0) for part in colour)
    return red, green, blue


def progress(frame: int, onset: int, over: int) -> float:
    """Return how far a change is that begins at a frame and takes so many: 0 to 1."""
    return min(1.0, max(0.0, (frame - onset) / over)) if over else float(frame >= onset)
