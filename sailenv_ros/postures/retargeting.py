"""Recorded motion on another body: a clip and a skeleton in, postures at any time out.

Bones turn as those of the recorded person, from the same pose of rest; lengths are the own. Places
are scaled by the legs. Feet that stand are found by height and speed of their balls, and then kept
where they are by inverse kinematics, so that they do not slide.
"""

from __future__ import annotations

from functools import cached_property
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.postures.figure import figure_of
from sailenv_ros.postures.limbs import bend_leg
from sailenv_ros.postures.planting import Planting, planted
from sailenv_ros.postures.skeleton import Posture
from sailenv_ros.postures.standing import SIDES, hands_at_ease
from sailenv_ros.types.humanoid import Humanoid, humanoid_of
from sailenv_ros.types.instance_states import rotation_matrices
from sailenv_ros.types.motion_clip import MotionClip
from sailenv_ros.types.rig import Rig
from sailenv_ros.types.rotations import between, quaternions_of

__all__ = ["RetargetedClip", "retargeted"]

Doubles = NDArray[np.float64]

_DROP_DEG = 9.0
"""By which shoulders are raised at rest, where arms are spread [deg]."""

_LEAST_M = 1e-6


class RetargetedClip:
    """A clip on a skeleton; the first frame is at the origin and looks along x.

    Parameters
    ----------
    clip : MotionClip
    rig : Rig

    Attributes
    ----------
    duration_s : float
    planting : tuple of Planting
        Left and right: when feet stand, and where.

    Raises
    ------
    AssetError
        If the clip is not that of a person.
    """

    def __init__(self, clip: MotionClip, rig: Rig) -> None:
        self._rig, self._figure = rig, figure_of(rig)
        self.duration_s, self._frame_s = clip.duration_s, clip.frame_s
        joints = humanoid_of(clip)
        turns, places = clip.in_world()
        first = _first_frame(turns)
        turns, places = turns[first:], places[first:]
        self.duration_s -= first * clip.frame_s
        body, world = _axes(clip, joints, turns)
        sources, fits = self._fits(clip, joints, body)
        self._names = list(sources)
        own = np.stack([world @ turns[:, sources[n]] @ body @ fits[n] for n in self._names], axis=1)
        self._lower_shoulders(own)
        self._quaternions = np.stack(
            [quaternions_of(own[:, k]) for k in range(len(self._names))], axis=1
        )
        hip = [joints.legs[side][0] for side in (0, 1)]
        middle = 0.5 * (places[:, hip[0]] + places[:, hip[1]]) @ world.T
        legs = [_length(clip, joints.legs[side][:3]) for side in (0, 1)]
        scale = self._figure.leg_m / max(0.5 * sum(legs), _LEAST_M)
        self._hips = scale * middle
        self._hips[:, :2] -= self._hips[0, :2].copy()
        self._plant(own)

    @property
    def way(self) -> Doubles:
        """(F, 2): where the hips are, on the floor [m]."""
        return self._hips[:, :2]

    @cached_property
    def end(self) -> tuple[float, float, float]:
        """Place on the floor at the end [m], and which way the hips look then [rad]."""
        x, y = self.way[-1].tolist()
        forward = rotation_matrices(self._quaternions[-1, :1])[0][:, 0]
        return x, y, float(np.arctan2(forward[1], forward[0]))

    def place_at(self, time_s: float) -> Doubles:
        """Return (2,): where the hips are on the floor at a time [m]."""
        frames = np.arange(len(self._hips)) * self._frame_s
        return np.array([np.interp(time_s, frames, self._hips[:, k]) for k in (0, 1)])

    def posture(self, time_s: float) -> Posture:
        """Return the posture at a time from the beginning [s]; the last one after the end."""
        last = len(self._hips) - 1
        place = float(np.clip(time_s / self._frame_s, 0.0, last))
        frame = min(int(place), max(last - 1, 0))
        share = place - frame
        after = min(frame + 1, last)
        quaternions = between(self._quaternions[frame], self._quaternions[after], share)
        matrices = rotation_matrices(quaternions)
        turns = dict(zip(self._names, matrices, strict=True))
        rig, figure = self._rig, self._figure
        hips = (1.0 - share) * self._hips[frame] + share * self._hips[after]
        for (side, _), planting in zip(SIDES, self.planting, strict=True):
            names = [f"{bone}.{side}" for bone in ("upperleg01", "lowerleg01", "foot")]
            thigh, shank, foot = (turns[name] for name in names)
            rest = [rig.head(name) for name in names]
            hip = hips + turns["root"] @ (rest[0] - figure.hips)
            ankle = hip + thigh @ (rest[1] - rest[0]) + shank @ (rest[2] - rest[1])
            ankle = planting.ankle(frame, after, share, ankle, foot @ figure.ball)
            turns |= bend_leg(rig, side, hip, ankle, foot, thigh[:, 0] + shank[:, 0])
        root = hips + turns["root"] @ (rig.heads[0] - figure.hips)
        for side, _ in SIDES:
            turns.setdefault(f"wrist.{side}", turns[f"lowerarm01.{side}"])
        hands = {f"lowerarm01.{side}": turns[f"wrist.{side}"] for side, _ in SIDES}
        return Posture(root_m=root, turns=turns | hands_at_ease(rig, hands))

    def _fits(
        self, clip: MotionClip, joints: Humanoid, body: Doubles
    ) -> tuple[dict[str, int], dict[str, Doubles]]:
        """Return the joint of the clip for each joint, and the turn between their poses of rest."""
        rig, straight = self._rig, np.eye(3)
        sources = {
            "root": joints.hips,
            "spine03": joints.spine,
            "spine01": joints.chest,
            "neck02": joints.neck,
            "head": joints.head,
        }
        fits = dict.fromkeys(sources, straight)

        def bone(names: tuple[str, str], first: int, second: int) -> Doubles:
            recorded = (clip.rest[second] - clip.rest[first]) @ body
            return _shortest(rig.head(names[1]) - rig.head(names[0]), recorded)

        for (side, _), leg, arm in zip(SIDES, joints.legs, joints.arms, strict=True):
            hip, knee, ankle, toe = leg
            collar, shoulder, elbow, wrist = arm
            chain = [f"{name}.{side}" for name in ("upperleg01", "lowerleg01", "foot", "toe1-1")]
            sources |= dict(zip(chain[:3], leg[:3], strict=True))
            fits[chain[0]] = bone((chain[0], chain[1]), hip, knee)
            fits[chain[1]] = bone((chain[1], chain[2]), knee, ankle)
            fits[chain[2]] = straight if toe < 0 else bone((chain[2], chain[3]), ankle, toe)
            sources[f"shoulder01.{side}"] = collar if collar >= 0 else joints.chest
            fits[f"shoulder01.{side}"] = straight
            limb = [f"{name}.{side}" for name in ("upperarm01", "lowerarm01", "wrist")]
            sources |= dict(zip(limb, (shoulder, elbow, wrist), strict=True))
            fits[limb[0]] = bone((limb[0], limb[1]), shoulder, elbow)
            fits[limb[1]] = fits[limb[2]] = bone((limb[1], limb[2]), elbow, wrist)
        return sources, fits

    def _lower_shoulders(self, own: Doubles) -> None:
        """Lower the shoulders of arms that hang, in place."""
        for side, sign in SIDES:
            upper, shoulder = (
                self._names.index(f"{bone}.{side}") for bone in ("upperarm01", "shoulder01")
            )
            rest = self._rig.head(f"lowerarm01.{side}") - self._rig.head(f"upperarm01.{side}")
            hangs = -(own[:, upper] @ (rest / np.linalg.norm(rest)))[:, 2]
            angle = np.radians(-_DROP_DEG * sign) * np.clip(hangs, 0.0, 1.0)
            turn = np.zeros((len(own), 4))
            turn[:, 0], turn[:, 3] = np.sin(0.5 * angle), np.cos(0.5 * angle)
            own[:, shoulder] = own[:, shoulder] @ rotation_matrices(turn)

    def _plant(self, own: Doubles) -> None:
        """Put the feet on the floor, find where they stand, and lower hips that are too high."""
        rig, figure = self._rig, self._figure
        root = own[:, 0]
        hips_to_sole, balls, needed = [], [], np.zeros(len(own))
        legs = []
        for side, _ in SIDES:
            names = [f"{bone}.{side}" for bone in ("upperleg01", "lowerleg01", "foot")]
            thigh, shank, foot = (own[:, self._names.index(name)] for name in names)
            rest = [rig.head(name) for name in names]
            hip = root @ (rest[0] - figure.hips)
            ankle = hip + thigh @ (rest[1] - rest[0]) + shank @ (rest[2] - rest[1])
            soles = np.stack([ankle + foot @ figure.ball, ankle + foot @ figure.heel], axis=1)
            hips_to_sole.append(soles[:, :, 2].min(axis=1))
            balls.append(self._hips + soles[:, 0])
            legs.append((hip, foot))
        lowest = self._hips[:, 2] + np.minimum(*hips_to_sole)
        floor = float(np.quantile(lowest, 0.05))
        self._hips[:, 2] -= floor
        self.planting: tuple[Planting, Planting] = (
            planted(balls[0] - [0.0, 0.0, floor], self._frame_s, figure.leg_m),
            planted(balls[1] - [0.0, 0.0, floor], self._frame_s, figure.leg_m),
        )
        most = 0.998 * figure.leg_m
        for (hip, foot), planting in zip(legs, self.planting, strict=True):
            away = planting.balls - foot @ figure.ball - (self._hips + hip)
            level = np.hypot(away[:, 0], away[:, 1])
            deep = np.sqrt(np.maximum(most**2 - np.minimum(level, most) ** 2, 0.0))
            needed = np.maximum(needed, np.where(planting.stands, -away[:, 2] - deep, 0.0))
        self._hips[:, 2] -= _widened(needed, max(1, round(0.1 / self._frame_s)))


_known: WeakKeyDictionary[Rig, WeakKeyDictionary[MotionClip, RetargetedClip]] = WeakKeyDictionary()


def retargeted(clip: MotionClip, rig: Rig) -> RetargetedClip:
    """Return a clip on a skeleton; the same object each time."""
    clips = _known.setdefault(rig, WeakKeyDictionary())
    if clip not in clips:
        clips[clip] = RetargetedClip(clip, rig)
    return clips[clip]


def _first_frame(turns: Doubles) -> int:
    """Return 1 if the first frame is but the pose of rest, as in many files; else 0."""
    if len(turns) < 4:
        return 0
    steps = np.einsum("fjab,fjab->fj", turns[:3], turns[1:4])  # 1 + 2 cos of the angle between them
    angles = np.degrees(np.arccos(np.clip(0.5 * (steps - 1.0), -1.0, 1.0))).max(axis=1)
    return int(angles[0] > 20.0 and angles[0] > 4.0 * angles[1:].max())


def _axes(clip: MotionClip, joints: Humanoid, turns: Doubles) -> tuple[Doubles, Doubles]:
    """Return (3, 3) the axes of the body at rest in those of the file, and the world from these.

    Up is the axis of the file along which the head is above the hips. The first frame looks along
    the x axis of the world.
    """
    rest = clip.rest
    above = rest[joints.head] - rest[joints.hips]
    axis = int(np.abs(above).argmax())
    up = np.zeros(3)
    up[axis] = np.sign(above[axis])
    across = rest[joints.legs[0][0]] - rest[joints.legs[1][0]]
    across = across - (across @ up) * up
    left = across / np.linalg.norm(across)
    body = np.stack([np.cross(left, up), left, up], axis=1)
    ahead = turns[0, joints.hips] @ body[:, 0]
    ahead = ahead - (ahead @ up) * up
    length = float(np.linalg.norm(ahead))
    ahead = ahead / length if length > 0.1 else body[:, 0]
    return body, np.stack([ahead, np.cross(up, ahead), up])


def _length(clip: MotionClip, joints: tuple[int, ...]) -> float:
    return float(np.linalg.norm(np.diff(clip.rest[list(joints)], axis=0), axis=1).sum())


def _shortest(start: Doubles, end: Doubles) -> Doubles:
    """Return the shortest rotation from one direction to another."""
    one, two = start / np.linalg.norm(start), end / max(float(np.linalg.norm(end)), _LEAST_M)
    cosine = float(one @ two)
    if cosine < -0.99999 or not two.any():
        return np.eye(3)
    x, y, z = np.cross(one, two)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn: Doubles = np.eye(3) + cross + cross @ cross / (1.0 + cosine)
    return turn


def _widened(values: Doubles, reach: int) -> Doubles:
    """Return values that are nowhere below the given ones, and change gently."""
    padded = np.pad(values, 2 * reach, mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * reach + 1)
    highest = windows.max(axis=1)
    kernel = np.hanning(2 * reach + 3)[1:-1]
    kernel /= kernel.sum()
    found: Doubles = np.convolve(highest, kernel, mode="valid")
    return found
