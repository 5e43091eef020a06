"""Fingers that close upon what a hand holds: each bends until it touches, then what lies beyond it.

A thing is as its box: upright in the hand, beside the palm, round along the fingers.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.postures.skeleton import Posture
from sailenv_ros.postures.standing import SIDES, about, curl_axis
from sailenv_ros.types.rig import Rig

__all__ = ["Grip", "Side", "away_from_thing", "finger_places", "grip_offset", "hand_at_rest"]
__all__ += ["with_fingers"]

Doubles = NDArray[np.float64]
Side = Literal["L", "R"]

_THICK = (0.125, 0.17, 0.19, 0.155, 0.135)
"""From a finger's bones to the skin inside, over the palm's length; from the thumb on."""

_TIP = 0.85
"""Length of the last bone of a finger, over that of the bone before it."""

_BENDS_DEG = ((-25.0, -15.0, 0.0), (80.0, 95.0, 60.0))
_THUMB_BENDS_DEG = ((0.0, 0.0, 0.0), (50.0, 50.0, 60.0))
"""Of an open finger's joints, and at most [deg]."""

_THUMB_WAYS_DEG = (-10.0, 5.0, 20.0, 35.0, 50.0, 65.0, 80.0, 95.0, 110.0)
"""From out of the palm towards the fingers: the thumb's ways, until one leads past the thing [deg].
"""

_THUMB_UP = 0.25
_STEPS, _HALVINGS = 48, 12
_ALONG_BONE = np.linspace(0.0, 1.0, 7)[1:]


@dataclass(frozen=True, slots=True, kw_only=True)
class Grip:
    """How a hand holds something.

    Attributes
    ----------
    half_m : float
        From the palm to the middle of what is held, before the scale [m].
    half_length_m, half_height_m : float
        Half its extent along the fingers, and along the thumb's side, before the scale [m].
    side : {'L', 'R'}
        The hand.
    """

    half_m: float
    half_length_m: float
    half_height_m: float
    side: Side = "R"

    def by(self, side: Side) -> Grip:
        """Return the same by a hand."""
        return replace(self, side=side)


@dataclass(frozen=True, eq=False, slots=True)
class _Closing:
    """A finger that holds something, at rest: what opposes it, and what bends it.

    Attributes
    ----------
    opposed : (3, 3) float64
        Turn of all its joints before they bend.
    axis : (3,) float64
        About which its joints bend.
    opened_deg, bends_deg : (3,) float64
        How far each bends when open, and when closed.
    """

    opposed: Doubles
    axis: Doubles
    opened_deg: Doubles
    bends_deg: Doubles

    def turns(self, share: float) -> list[Doubles]:
        """Return the turns of its joints from the hand, closed by a share."""
        bends = self.opened_deg + share * (self.bends_deg - self.opened_deg)
        return [
            about(self.axis, np.radians(degrees)) @ self.opposed for degrees in np.cumsum(bends)
        ]


_known: WeakKeyDictionary[Rig, dict[Grip, dict[int, _Closing]]] = WeakKeyDictionary()


def with_fingers(rig: Rig, posture: Posture, grip: Grip, closed: float) -> Posture:
    """Return a posture whose fingers hold something.

    Parameters
    ----------
    posture : Posture
        In which the wrist is turned.
    closed : float
        From 0, open, to 1, where they touch.
    """
    hand = posture.turns[f"wrist.{grip.side}"]
    turns = dict(posture.turns)
    for finger, closing in _closings(rig, grip).items():
        for joint, turn in enumerate(closing.turns(closed), start=1):
            turns[f"finger{finger}-{joint}.{grip.side}"] = hand @ turn
    return replace(posture, turns=turns)


def hand_at_rest(rig: Rig, side: Side) -> tuple[Doubles, Doubles, Doubles, float]:
    """Return unit vectors along the fingers, the thumb's side, out of the palm; its length [m]."""
    wrist = rig.head(f"wrist.{side}")
    knuckles = [rig.head(f"finger{number}-1.{side}") for number in (2, 3, 5)]
    along = knuckles[1] - wrist
    length = float(np.linalg.norm(along))
    thumb = knuckles[0] - knuckles[2]
    thumb = thumb - (thumb @ along) * along / length**2
    along, thumb = along / length, thumb / np.linalg.norm(thumb)
    return along, thumb, dict(SIDES)[side] * np.cross(along, thumb), length


def grip_offset(rig: Rig, grip: Grip) -> Doubles:
    """Return (3,): from the wrist to the middle of what is held, at rest [m]."""
    along, _, palm, length = hand_at_rest(rig, grip.side)
    wrist = rig.head(f"wrist.{grip.side}")
    inside = [
        (rig.head(f"finger{n}-1.{grip.side}") - wrist) @ palm + _THICK[n - 1] * length
        for n in range(2, 6)
    ]
    away = grip.half_m + float(max(inside))
    return np.asarray(1.05 * length * along + away * palm)


def finger_places(rig: Rig, side: Side, finger: int, turns: list[Doubles]) -> Doubles:
    """Return (3, N, 3): places along a finger's three bones, for turns from the hand at rest [m].

    The last is at the tip.
    """
    heads = [rig.head(f"finger{finger}-{joint}.{side}") for joint in (1, 2, 3)]
    bones = [heads[1] - heads[0], heads[2] - heads[1], _TIP * (heads[2] - heads[1])]
    found, begin = [], heads[0]
    for turn, bone in zip(turns, bones, strict=True):
        found.append(begin + _ALONG_BONE[:, None] * (turn @ bone))
        begin = found[-1][-1]
    return np.stack(found)


def away_from_thing(rig: Rig, grip: Grip, finger: int, places: Doubles) -> Doubles:
    """Return (...): from a finger's skin around places to what is held; negative within it [m].

    Parameters
    ----------
    places : (..., 3) float64
        Of its bones, in the hand at rest [m].
    """
    along, thumb, palm, length = hand_at_rest(rig, grip.side)
    own = places - rig.head(f"wrist.{grip.side}") - grip_offset(rig, grip)
    straight = max(grip.half_length_m - grip.half_m, 0.0)
    beyond = np.maximum(np.abs(own @ along) - straight, 0.0)
    level = np.hypot(beyond, own @ palm) - min(grip.half_m, max(grip.half_length_m, 1e-4))
    above = np.maximum(np.abs(own @ thumb) - grip.half_height_m, 0.0)
    outside = np.where(above > 0.0, np.hypot(np.maximum(level, 0.0), above), level)
    return np.asarray(outside - _THICK[finger - 1] * length)


def _closings(rig: Rig, grip: Grip) -> dict[int, _Closing]:
    """Return how each finger closes; the same objects each time."""
    known = _known.setdefault(rig, {})
    if grip not in known:
        known[grip] = {1: _thumb(rig, grip)} | {n: _finger(rig, grip, n) for n in range(2, 6)}
    return known[grip]


def _finger(rig: Rig, grip: Grip, finger: int) -> _Closing:
    axis = curl_axis(rig, grip.side, finger)
    bends = np.array(_BENDS_DEG[0])
    opened = _Closing(np.eye(3), axis, bends, bends)
    return _closed(rig, grip, finger, opened, np.array(_BENDS_DEG[1]))


def _thumb(rig: Rig, grip: Grip) -> _Closing:
    """Return a thumb that goes round the thing on the other side than the fingers."""
    along, upwards, palm, _ = hand_at_rest(rig, grip.side)
    begin, end = (rig.head(f"finger1-{joint}.{grip.side}") for joint in (1, 2))
    bone = (end - begin) / np.linalg.norm(end - begin)
    to_middle = rig.head(f"wrist.{grip.side}") + grip_offset(rig, grip) - begin
    best, clear = None, -np.inf
    for degrees in np.radians(_THUMB_WAYS_DEG):
        way = np.sin(degrees) * along + np.cos(degrees) * palm + _THUMB_UP * upwards
        way /= np.linalg.norm(way)
        turn, angle = np.cross(bone, way), float(np.degrees(np.arccos(bone @ way)))
        bends = np.cross(way, to_middle - (to_middle @ upwards) * upwards)
        turn, bends = (axis / max(float(np.linalg.norm(axis)), 1e-9) for axis in (turn, bends))
        straight = np.array(_THUMB_BENDS_DEG[0])
        opened = _Closing(about(turn, np.radians(angle)), bends, straight, straight)
        away = float(_away(rig, grip, 1, opened).min())
        if away > clear + 1e-6:
            best, clear = opened, away
        if away >= 0.0:
            break
    assert best is not None
    return _closed(rig, grip, 1, best, np.array(_THUMB_BENDS_DEG[1]))


def _away(rig: Rig, grip: Grip, finger: int, closing: _Closing) -> Doubles:
    """Return (3,): how far a finger's bones are from what is held [m]."""
    places = finger_places(rig, grip.side, finger, closing.turns(1.0))
    return np.asarray(away_from_thing(rig, grip, finger, places).min(axis=1))


def _closed(rig: Rig, grip: Grip, finger: int, opened: _Closing, most: Doubles) -> _Closing:
    """Return a finger that bends: all joints alike until a bone touches, then those beyond it."""
    bends, free = opened.bends_deg, 0
    shares = np.linspace(0.0, 1.0, _STEPS + 1).tolist()

    def at(share: float) -> _Closing:
        more = np.where(np.arange(3) >= free, share * (most - bends), 0.0)
        return replace(opened, bends_deg=bends + more)

    def sunk(share: float) -> NDArray[np.bool_]:
        return _away(rig, grip, finger, at(share))[free:] < 0.0

    while free < 3:
        high = next((share for share in shares if sunk(share).any()), None)
        if high is None:
            return at(1.0)
        low = max(high - shares[1], 0.0)
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if sunk(middle).any() else (middle, high)
        touching = free + int(sunk(high).argmax())
        bends, free = at(low).bends_deg, touching + 1
    return at(0.0)
