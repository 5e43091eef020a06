"""`room_view`: cameras as somebody would stand who takes a picture of the room."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from pydantic import Field

from sailenv_ros.authoring.viewpoints.free_view import FreeView, poses_in_free_space
from sailenv_ros.authoring.viewpoints.view_scene import CameraView, ViewScene, camera_rule
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.labels import PART_MARK

__all__ = ["ViewScore", "RoomView", "view_score", "room_view"]

FULL_SHARE = 1 / 15
"""Share of the picture above which an object counts no more, so that one couch does not outweigh a
room."""

CLOSE_M = 1.1
MOST_CLOSE = 0.05
MOST_OF_ONE = 0.15
DEEP_M = 3.5


class RoomView(FreeView):
    """Settings of `room_view`: those of `free_view` with others for a start."""

    attempts: int = Field(
        default=60, ge=1, le=10_000, description="poses that are looked through, in all"
    )
    height_m: tuple[float, float] = Field(
        default=(1.3, 1.6), description="of the camera above the floor [m]"
    )
    pitch_deg: tuple[float, float] = Field(
        default=(4.0, 14.0), description="downwards from level [deg]"
    )
    objects: int = Field(default=3, ge=0, le=1000, description="least number of objects in view")


@dataclass(frozen=True, slots=True, kw_only=True)
class ViewScore:
    """Measures of the view from a pose.

    Attributes
    ----------
    pose : Pose
    shares : mapping of int to float
        Of the picture, by the ids of objects. Parts count as what they belong to, but for what
        opens: a row of cupboards is worth looking at.
    depth_m : float
        Median of the picture's depth [m].
    nearest_m : float
        Least depth [m]; 0 if something is nearer than can be seen.
    close : float
        Share of the picture that is nearer than an arm's length or two.
    """

    pose: Pose
    shares: Mapping[int, float]
    depth_m: float
    nearest_m: float
    close: float

    def worth(self, times: Mapping[int, int] | None = None) -> float:
        """Return how good a picture it is: many objects, a wide view, nothing large before it.

        Parameters
        ----------
        times : mapping of int to int or None
            How often each object has been shown; it counts half as much each time.
        """
        shown = times or {}
        seen = sum(
            math.sqrt(min(share, FULL_SHARE)) * math.pow(0.5, shown.get(id_, 0))
            for id_, share in self.shares.items()
        )
        largest = max(self.shares.values(), default=0.0)
        return (
            seen
            + 0.35 * min(DEEP_M, self.depth_m)
            - 3.0 * max(0.0, self.close - MOST_CLOSE)
            - 2.0 * max(0.0, largest - MOST_OF_ONE)
        )


def view_score(scene: ViewScene, pose: Pose) -> ViewScore:
    """Return what is seen from a pose."""
    # NaN is nearer than the near plane.
    depth = np.nan_to_num(scene.depth_m(pose).astype(np.float64), nan=0.0, posinf=1e4)
    wholes = {
        drawn.instance.id: drawn.instance.parent
        for drawn in scene.snapshot.contents.instances
        if PART_MARK in drawn.instance.name
    }
    counts: Counter[int] = Counter()
    for id_, count in scene.seen(pose, 0.0).items():
        counts[wholes.get(id_, id_)] += count
    return ViewScore(
        pose=pose,
        shares={id_: count / depth.size for id_, count in counts.items()},
        depth_m=float(np.median(depth)),
        nearest_m=float(depth.min()),
        close=float((depth < CLOSE_M).mean()),
    )


@camera_rule("room_view", RoomView)
def room_view(
    scene: ViewScene, settings: RoomView, count: int, random: np.random.Generator
) -> list[CameraView]:
    """Look across the room from free space: much furniture, a wide view, nothing large in front.

    Each next view counts half what those before it show.
    """
    seen = (view_score(scene, pose) for pose in poses_in_free_space(scene, settings, random))
    candidates = [
        view
        for view in itertools.islice(seen, settings.attempts)
        if view.nearest_m >= settings.nearest_m
        and sum(view.shares.values()) >= settings.filled
        and sum(share >= settings.cover for share in view.shares.values()) >= settings.objects
    ]
    times: Counter[int] = Counter()
    chosen: list[CameraView] = []
    while candidates and len(chosen) < count:
        best = candidates.pop(int(np.argmax([view.worth(times) for view in candidates])))
        times.update(best.shares.keys())
        chosen.append(CameraView(pose=best.pose))
    return chosen
