"""BVH files → `MotionClip`s: joints, channels in any order of axes, frames.

The format: M. Meredith, S. Maddock, *Motion Capture File Formats Explained*, 2001. Rotations are
composed in the order of their channels; positions of joints other than the first are left out, as
bones do not change their length.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import AssetError
from sailenv_ros.types.motion_clip import MotionClip

__all__ = ["MOST_DEPTH", "MOST_FRAMES", "MOST_JOINTS", "MOST_TURNS", "read_bvh"]

Doubles = NDArray[np.float64]

MOST_FRAMES, MOST_JOINTS, MOST_DEPTH = 30_000, 400, 100
MOST_TURNS = 1_500_000
"""Joints times frames that are accepted."""

_LONGEST_FRAME_S = 1.0
_CHANNELS = tuple(f"{axis}{kind}" for kind in ("position", "rotation") for axis in "XYZ")
_SHOWN = 40


@dataclass(slots=True)
class _Joint:
    name: str
    parent: int
    offset: tuple[float, float, float] | None = None
    channels: list[str] = field(default_factory=list)


class _Words:
    """Words of a text, each with its line."""

    def __init__(self, name: str, text: str) -> None:
        self.name = name
        self.lines = text.splitlines()
        self._row, self.line = 0, 0
        self._ahead: list[str] = []

    def next(self, wanted: str) -> str:
        """Return the next word."""
        while not self._ahead:
            if self._row >= len(self.lines):
                raise self.wrong(f"it ends where {wanted} is expected")
            self._ahead = self.lines[self._row].split()[::-1]
            self._row += 1
        self.line = self._row
        return self._ahead.pop()

    def until_brace(self) -> str:
        """Return the words up to a brace on this line or the next, which is read, too."""
        words: list[str] = []
        while self._ahead and self._ahead[-1] != "{":
            words.append(self._ahead.pop())
        self.expect("{")
        return " ".join(words)

    def expect(self, *words: str) -> str:
        """Return the next word, which must be one of these."""
        found = self.next(" or ".join(words))
        for word in words:
            if found.upper() == word.upper():
                return word
        raise self.wrong(f"{' or '.join(words)} is expected, and {found[:_SHOWN]!r} stands there")

    def number(self, what: str) -> float:
        """Return the next word as a finite number."""
        return self.finite(self.next(what), what)

    def finite(self, word: str, what: str) -> float:
        """Return a word as a finite number."""
        try:
            value = float(word)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise self.wrong(f"{what} must be a finite number, got {word[:_SHOWN]!r}")
        return value

    def count(self, what: str, least: int, most: int) -> int:
        """Return the next word as a number of things."""
        word = self.next(what)
        if not word.isascii() or not word.isdigit() or not least <= int(word[:12]) <= most:
            raise self.wrong(f"{what} must be {least} to {most}, got {word[:_SHOWN]!r}")
        return int(word)

    def wrong(self, why: str) -> AssetError:
        """Make an error of the line that was read last."""
        return AssetError(f"{self.name}:{max(self.line, 1)}", why)

    @property
    def begun(self) -> int:
        """Number of lines that have been begun."""
        return self._row


def read_bvh(name: str, data: bytes) -> MotionClip:
    """Return the motion of a BVH file.

    Parameters
    ----------
    name : str
        Of the file, for errors.
    data : bytes

    Raises
    ------
    AssetError
        If it is malformed, or has more joints or frames than are accepted; with the line.
    """
    words = _Words(name, data.decode("utf-8-sig", "replace"))
    words.expect("HIERARCHY")
    joints = _hierarchy(words)
    words.expect("Frames:")
    frames = words.count("the number of frames", 1, min(MOST_FRAMES, MOST_TURNS // len(joints)))
    words.expect("Frame")
    words.expect("Time:")
    frame_s = words.number("the time of a frame")
    if not 0.0 < frame_s <= _LONGEST_FRAME_S:
        raise words.wrong(f"the time of a frame must be above 0 and at most 1 s, got {frame_s:g}")
    values = _values(words, frames, sum(len(joint.channels) for joint in joints))
    return _clip(name, joints, values, frame_s)


def _hierarchy(words: _Words) -> list[_Joint]:
    """Read the joints, up to the word MOTION."""
    joints: list[_Joint] = []
    names: dict[str, int] = {}
    above: list[int] = []
    words.expect("ROOT")
    _begin(words, joints, names, above, "ROOT")
    while above:
        joint = joints[above[-1]]
        word = words.expect("OFFSET", "CHANNELS", "JOINT", "End", "}")
        if word == "OFFSET":
            if joint.offset is not None:
                raise words.wrong(f"joint {joint.name[:_SHOWN]!r} has two offsets")
            x, y, z = (words.number("an offset") for _ in range(3))
            joint.offset = x, y, z
        elif word == "CHANNELS":
            _channels(words, joint)
        elif word == "}":
            if joint.offset is None:
                raise words.wrong(f"joint {joint.name[:_SHOWN]!r} has no offset")
            above.pop()
        else:
            _begin(words, joints, names, above, word)
    if words.expect("MOTION", "ROOT") == "ROOT":
        raise words.wrong("it has a second ROOT, and one skeleton is accepted")
    return joints


def _begin(
    words: _Words, joints: list[_Joint], names: dict[str, int], above: list[int], word: str
) -> None:
    """Read the beginning of a joint, up to its brace."""
    first, line = words.next("a name"), words.line
    label = f"{first} {words.until_brace()}".strip()
    name = label if word != "End" else f"{joints[above[-1]].name} end"
    if len(joints) >= MOST_JOINTS or len(above) >= MOST_DEPTH:
        most = f"up to {MOST_JOINTS} joints, {MOST_DEPTH} one below the other, are accepted"
        raise words.wrong(f"it has too many joints: {most}")
    if name in names and word != "End":
        words.line = line
        raise words.wrong(
            f"joint {name[:_SHOWN]!r} is there already, in line {names[name]}: each stands once"
        )
    names[name] = line
    joints.append(_Joint(name, above[-1] if above else -1))
    above.append(len(joints) - 1)


def _channels(words: _Words, joint: _Joint) -> None:
    if joint.channels:
        raise words.wrong(f"joint {joint.name[:_SHOWN]!r} has its channels twice")
    for _ in range(words.count("the number of channels", 0, len(_CHANNELS))):
        channel = words.expect(*_CHANNELS)
        if channel in joint.channels:
            raise words.wrong(f"channel {channel} of {joint.name[:_SHOWN]!r} stands there twice")
        joint.channels.append(channel)


def _values(words: _Words, frames: int, width: int) -> Doubles:
    """Read (F, C) numbers, a line for each frame."""
    found = np.empty((frames, width))
    row = words.begun
    for frame in range(frames):
        while row < len(words.lines) and not words.lines[row].strip():
            row += 1
        words.line = row + 1
        if row >= len(words.lines):
            raise words.wrong(f"it ends after {frame} of {frames} frames")
        line = words.lines[row].split()
        row += 1
        if len(line) != width:
            raise words.wrong(f"a frame has {width} numbers, and this line has {len(line)}")
        try:
            found[frame] = line
        except ValueError:
            found[frame] = math.nan
        if not np.isfinite(found[frame]).all():
            for word in line:
                words.finite(word, "a channel")
    return found


def _clip(name: str, joints: Sequence[_Joint], values: Doubles, frame_s: float) -> MotionClip:
    frames = len(values)
    turns = np.broadcast_to(np.eye(3), (frames, len(joints), 3, 3)).copy()
    first = joints[0].offset
    assert first is not None
    roots = np.tile(np.array(first), (frames, 1))
    column = 0
    for number, joint in enumerate(joints):
        for channel in joint.channels:
            axis, value = "XYZ".index(channel[0]), values[:, column]
            column += 1
            if channel.endswith("rotation"):
                turns[:, number] = turns[:, number] @ _about(axis, np.radians(value))
            elif number == 0:
                roots[:, axis] = value
    return MotionClip(
        name=name,
        joint_names=tuple(joint.name for joint in joints),
        parents=np.array([joint.parent for joint in joints], np.int64),
        offsets=np.array([joint.offset for joint in joints], np.float64),
        turns=turns,
        roots=roots,
        frame_s=frame_s,
    )


def _about(axis: int, angles: Doubles) -> Doubles:
    """Return (F, 3, 3) rotations about an axis [rad]."""
    found = np.zeros((len(angles), 3, 3))
    one, two = (axis + 1) % 3, (axis + 2) % 3
    found[:, axis, axis] = 1.0
    found[:, one, one] = found[:, two, two] = np.cos(angles)
    found[:, two, one] = np.sin(angles)
    found[:, one, two] = -found[:, two, one]
    return found
