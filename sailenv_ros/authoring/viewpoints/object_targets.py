"""Objects to look at and cameras around them: who may be seen, and from where.

A snapshot of a room in, targets and random cameras out. Draws nothing.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import look_at
from sailenv_ros.types.snapshot import DrawnInstance, WorldSnapshot

__all__ = [
    "Rule",
    "Target",
    "between_deg",
    "boxes_of",
    "cameras",
    "is_outside",
    "stands_in_something",
    "target_of_row",
    "targets_of",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class Rule:
    """Conditions that a viewpoint must meet.

    Attributes
    ----------
    viewpoints : int
        Of each class.
    cover : (2,) tuple of float
        Least and greatest share of the picture that the object's visible pixels take.
    visible : float
        Least share of the object that is seen: its pixels over those it would have alone, the part
        beyond the picture's borders included.
    apart_deg : float
        Least angle between the azimuths of two viewpoints of one object [deg].
    elevation_deg : (2,) tuple of float
        Lowest and highest camera above the horizon [deg].
    attempts : int
        Cameras that are tried for each viewpoint before it is given up.
    seed : int
    """

    viewpoints: int = 5
    cover: tuple[float, float] = (0.02, 0.6)
    visible: float = 0.7
    apart_deg: float = 20.0
    elevation_deg: tuple[float, float] = (5.0, 60.0)
    attempts: int = 200
    seed: int = 0


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Target:
    """An object in its room.

    Attributes
    ----------
    room : str
        Name of the scene.
    row : int
        Of the snapshot's instances.
    snapshot, alone : WorldSnapshot
        The room, and the object in it without anything else.
    boxes : (N, 2, 3) float64
        Of all the room's objects, see `boxes_of`.
    middle : (3,) float64
        Of its box, in the world [m].
    size_m : float
        Diagonal of its box [m].
    """

    room: str
    row: int
    snapshot: WorldSnapshot
    alone: WorldSnapshot
    boxes: NDArray[np.float64]
    middle: NDArray[np.float64]
    size_m: float

    @property
    def drawn(self) -> DrawnInstance:
        """The drawn instance."""
        return self.snapshot.contents.instances[self.row]


def boxes_of(snapshot: WorldSnapshot) -> NDArray[np.float64]:
    """Return (N, 2, 3) the lowest and the highest corner of each object in its own axes [m]."""
    drawn = snapshot.contents.instances
    return np.stack([entry.model.bounds() * np.asarray(entry.scale) for entry in drawn])


def boxes_in_world(boxes: NDArray[np.float64], poses: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (N, 2, 3) the lowest and the highest corner of the boxes around turned boxes [m].

    Parameters
    ----------
    boxes : (N, 2, 3) float64
        Corners in axes of their own [m]; see `boxes_of`.
    poses : (N, 4, 4) float64
        World from these axes.
    """
    middles = np.append(boxes.mean(axis=1), np.ones((len(boxes), 1)), axis=1)
    centres = np.einsum("nij,nj->ni", poses, middles)[:, :3]
    halves = np.einsum("nij,nj->ni", np.abs(poses[:, :3, :3]), np.ptp(boxes, axis=1) / 2.0)
    return np.stack([centres - halves, centres + halves], axis=1)


def targets_of(
    room: str, snapshot: WorldSnapshot, boxes: NDArray[np.float64], category: str
) -> Iterator[Target]:
    """Yield the objects of a category in a room."""
    for row, drawn in enumerate(snapshot.contents.instances):
        if drawn.instance.category == category:
            yield target_of_row(room, snapshot, boxes, row)


def target_of_row(
    room: str, snapshot: WorldSnapshot, boxes: NDArray[np.float64], row: int
) -> Target:
    """Return the object of a row of a snapshot."""
    low, high = boxes[row]
    only = snapshot.of_rows(np.array([row]))
    pose = snapshot.world_from_body[row]
    return Target(
        room=room,
        row=row,
        snapshot=snapshot,
        alone=replace(only, contents=replace(only.contents, lights=(), baked=None)),
        boxes=boxes,
        middle=pose[:3, :3] @ (0.5 * (low + high)) + pose[:3, 3],
        size_m=float(np.linalg.norm(high - low)),
    )


def cameras(
    target: Target, rule: Rule, lens: CameraIntrinsics, random: np.random.Generator
) -> Iterator[tuple[float, Camera, float]]:
    """Yield azimuth [deg], camera and distance [m]: as many as the rule's attempts."""
    for _ in range(rule.attempts):
        azimuth_deg = float(random.uniform(0.0, 360.0))
        elevation_deg = float(random.uniform(*rule.elevation_deg))
        # The share of the picture that a ball around the object would fill, which it seldom does.
        filled = math.exp(random.uniform(math.log(rule.cover[0] * 3.0), math.log(1.6)))
        distance_m = max(0.12, 0.5 * target.size_m / (lens.half_height * math.sqrt(filled)))
        a, e = math.radians(azimuth_deg), math.radians(elevation_deg)
        towards = np.array([math.cos(a) * math.cos(e), math.sin(a) * math.cos(e), math.sin(e)])
        pose = look_at(target.middle + distance_m * towards, target.middle)
        yield azimuth_deg, Camera(intrinsics=lens, pose=pose), distance_m


def stands_in_something(target: Target, eye: NDArray[np.float64]) -> bool:
    """Return whether a camera is inside a wall or furniture: in a box that is not around both."""
    eye_in, middle_in = (_in_boxes(target, point) for point in (eye, target.middle))
    return bool((eye_in & ~middle_in).any())


def is_outside(target: Target, eye: NDArray[np.float64]) -> bool:
    """Return whether a scene has ceilings, and none of them is above or below a camera."""
    drawn = target.snapshot.contents.instances
    ceilings = [row for row, entry in enumerate(drawn) if entry.instance.category == "ceiling"]
    return bool(ceilings) and not _between_sides(target, eye)[ceilings, :2].all(axis=1).any()


def _in_boxes(target: Target, point: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return (N,) in which objects' boxes, each in its own axes, a point of the world lies."""
    inside: NDArray[np.bool_] = np.asarray(_between_sides(target, point).all(axis=1))
    return inside


def _between_sides(target: Target, point: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return (N, 3) along which of its own axes each box has a point of the world between sides."""
    poses = target.snapshot.world_from_body
    own = np.einsum("nij,ni->nj", poses[:, :3, :3], point - poses[:, :3, 3])
    between: NDArray[np.bool_] = (target.boxes[:, 0] <= own) & (own <= target.boxes[:, 1])
    return between


def between_deg(first: float, second: float) -> float:
    """Return the angle between two azimuths, 0 to 180."""
    return abs((first - second + 180.0) % 360.0 - 180.0)
