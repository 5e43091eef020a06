"""Roles of the joints of a recorded skeleton, however its makers call them.

Files agree on little more than that a left foot has 'left' or 'l' in its name. Hands, feet and the
head are sought by names; knees, hips, elbows and shoulders are the joints above them.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from sailenv_ros.errors import AssetError
from sailenv_ros.types.motion_clip import MotionClip

__all__ = ["Humanoid", "humanoid_of"]

_SIDES = {
    "left": re.compile(r"^(?i:left)|^[lL](?=[A-Z_.\- ])|(?i:left)$|[_.\- ][lL](?=$|[_.\- ])"),
    "right": re.compile(r"^(?i:right)|^[rR](?=[A-Z_.\- ])|(?i:right)$|[_.\- ][rR](?=$|[_.\- ])"),
}
_FOOT, _TOE, _HAND, _HEAD = ("foot", "ankle"), ("toe", "ball"), ("hand", "wrist"), ("head",)
_SKIPPED = re.compile(r"twist|roll|thumb|finger|index", re.IGNORECASE)
_LEAST = 1e-4
"""Shortest bone, over the distance from hips to head."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Humanoid:
    """Numbers of the joints of a clip.

    Attributes
    ----------
    hips, chest, head : int
    spine : int
        Half way from the hips to the chest.
    neck : int
    legs : tuple of (int, int, int, int)
        Left and right: hip, knee, ankle, toes; the last is -1 where there are none.
    arms : tuple of (int, int, int, int)
        Left and right: collar, shoulder, elbow, wrist; the first is -1 where there is none.
    """

    hips: int
    spine: int
    chest: int
    neck: int
    head: int
    legs: tuple[tuple[int, int, int, int], tuple[int, int, int, int]]
    arms: tuple[tuple[int, int, int, int], tuple[int, int, int, int]]


def humanoid_of(clip: MotionClip) -> Humanoid:
    """Find the joints of a human skeleton.

    Raises
    ------
    AssetError
        If a foot, a hand or the head is not found, or has too few joints above it.
    """
    found = _Finder(clip)
    head = found.first(_HEAD, "")
    legs = tuple(found.leg(side) for side in ("left", "right"))
    arms = tuple(found.arm(side) for side in ("left", "right"))
    above = [set(found.path(arm[1])) for arm in arms]
    shared = [joint for joint in found.path(head) if joint in above[0] & above[1]]
    if not shared:
        raise AssetError(clip.name, "its arms and its head have no joint in common")
    chest = shared[0]
    hips = next(joint for joint in found.path(legs[0][0]) if joint in found.path(legs[1][0]))
    trunk = [joint for joint in found.path(chest) if joint not in found.path(hips)][::-1]
    # The axis of the file along which the head is above the hips, and the hips across it.
    above_hips = clip.rest[head] - clip.rest[hips]
    axis = int(np.abs(above_hips).argmax())
    across = np.delete(clip.rest[legs[0][0]] - clip.rest[legs[1][0]], axis)
    size = float(np.ptp(clip.rest))
    if abs(above_hips[axis]) < 0.05 * size or float(np.linalg.norm(across)) < 0.01 * size:
        raise AssetError(clip.name, "its hips have no width at rest, or its head is not above them")
    neck = found.path(head)[: found.path(head).index(chest)][-1]
    return Humanoid(
        hips=hips,
        spine=trunk[len(trunk) // 2] if trunk else hips,
        chest=chest,
        neck=neck,
        head=head,
        legs=(legs[0], legs[1]),
        arms=(arms[0], arms[1]),
    )


class _Finder:
    """Looks for joints of a clip."""

    def __init__(self, clip: MotionClip) -> None:
        self._clip = clip
        self._parents: list[int] = clip.parents.tolist()
        self._lengths = np.linalg.norm(clip.offsets, axis=1)
        self._least = _LEAST * max(float(np.ptp(clip.rest)), 1e-9)
        self._names = [name.rpartition(":")[2] for name in clip.joint_names]

    def path(self, joint: int) -> list[int]:
        """Return a joint and all above it, up to the root."""
        found = []
        while joint >= 0:
            found.append(joint)
            joint = self._parents[joint]
        return found

    def first(self, words: tuple[str, ...], side: str) -> int:
        """Return the joint nearest to the root whose name has one of some words, and a side."""
        found = [
            (len(self.path(joint)), joint)
            for joint, name in enumerate(self._names)
            if _says(name, words) and not _SKIPPED.search(name) and _side(name) == side
        ]
        if not found:
            wanted = " or ".join(repr(word) for word in words)
            sided = f" {side!r} or {side[0]!r} and" if side else ""
            raise AssetError(
                self._clip.name, f"no joint has{sided} {wanted} in its name, as those of people do"
            )
        return min(found)[1]

    def above(self, joint: int) -> int:
        """Return the next joint above with a bone between them."""
        start = joint
        while self._parents[joint] >= 0:
            has_bone = self._lengths[joint] > self._least
            joint = self._parents[joint]
            if has_bone and not _SKIPPED.search(self._names[joint]):
                return joint
        raise AssetError(
            self._clip.name, f"joint {self._names[start][:40]!r} has too few joints above it"
        )

    def leg(self, side: str) -> tuple[int, int, int, int]:
        """Return hip, knee, ankle and toes."""
        ankle = self.first(_FOOT, side)
        knee = self.above(ankle)
        toes = [
            joint
            for joint, parent in enumerate(self._parents)
            if parent == ankle and self._lengths[joint] > self._least
        ]
        named = [joint for joint in toes if _says(self._names[joint], _TOE)]
        return self.above(knee), knee, ankle, (named or toes or [-1])[0]

    def arm(self, side: str) -> tuple[int, int, int, int]:
        """Return collar, shoulder, elbow and wrist."""
        wrist = self.first(_HAND, side)
        elbow = self.above(wrist)
        shoulder = self.above(elbow)
        collar = self._parents[shoulder]
        sided = collar >= 0 and _side(self._names[collar]) == side
        return collar if sided else -1, shoulder, elbow, wrist


def _side(name: str) -> str:
    return next((side for side, pattern in _SIDES.items() if pattern.search(name)), "")


def _says(name: str, words: tuple[str, ...]) -> bool:
    return any(word in name.lower() for word in words)
