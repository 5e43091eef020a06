"""`free_view`: cameras as somebody would carry them, who walks through free space."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from sailenv_ros.authoring.viewpoints.view_scene import (
    CameraView,
    RuleSettings,
    ViewScene,
    camera_rule,
)
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.space.free_space import BodySize
from sailenv_ros.types.geometry import Pose, vector_angle_deg

__all__ = ["FreeView", "free_view", "poses_in_free_space"]

Range = tuple[float, float]


class FreeView(RuleSettings):
    """Settings of `free_view`."""

    height_m: Range = Field(default=(1.2, 1.7), description="of the camera above the floor [m]")
    pitch_deg: Range = Field(default=(0.0, 25.0), description="downwards from level [deg]")
    clearance_m: float = Field(
        default=0.25, ge=0.0, le=10.0, description="between the camera and what stands around [m]"
    )
    nearest_m: float = Field(
        default=0.5, ge=0.0, le=100.0, description="least depth of a surface in the picture [m]"
    )
    objects: int = Field(default=4, ge=0, le=1000, description="least number of objects in view")
    cover: float = Field(
        default=0.002, ge=0.0, le=1.0, description="of the picture, from which an object counts"
    )
    filled: float = Field(
        default=0.0,
        ge=0.0,
        le=1.0,
        description="least share of the picture that objects take, not parts of the room",
    )
    apart_m: float = Field(
        default=0.5, ge=0.0, le=100.0, description="between two cameras that look the same way [m]"
    )
    apart_deg: float = Field(
        default=40.0, ge=0.0, le=180.0, description="between two cameras in the same place [deg]"
    )
    floor_m: float = Field(default=0.0, description="height of the floor in the world [m]")


def poses_in_free_space(
    scene: ViewScene, settings: FreeView, random: np.random.Generator
) -> Iterator[Pose]:
    """Yield random poses at places where a body of that height and clearance can stand.

    Raises
    ------
    InvalidRequest
        If a range ends before it begins, or the camera is not above the floor.
    """
    low, high = settings.height_m
    if not 0.0 < low <= high:
        raise InvalidRequest("height_m", settings.height_m, "a range above 0 [m]")
    if not -90.0 <= settings.pitch_deg[0] <= settings.pitch_deg[1] <= 90.0:
        raise InvalidRequest("pitch_deg", settings.pitch_deg, "a range within -90 and 90 [deg]")
    body = BodySize(
        # The head is as far from what hangs above as the body from what stands around.
        height_m=high + settings.clearance_m,
        radius_m=settings.clearance_m,
        floor_m=settings.floor_m,
        step_m=min(0.05, 0.5 * low),
    )
    space = scene.free_space(body)
    cells = np.argwhere(space.regions == 1)
    while len(cells):
        row, column = cells[int(random.integers(len(cells)))].tolist()
        x, y, floor = space.position_of(row, column)
        height = float(random.uniform(low, high))
        pitch = float(random.uniform(*settings.pitch_deg))
        yaw = float(random.uniform(-180.0, 180.0))
        yield Pose.from_rpy_deg((x, y, floor + height), (0.0, pitch, yaw))


@camera_rule("free_view", FreeView)
def free_view(
    scene: ViewScene, settings: FreeView, count: int, random: np.random.Generator
) -> list[CameraView]:
    """Look from free space at a height, nothing too near, several objects in view."""
    chosen: list[CameraView] = []
    forwards: list[NDArray[np.float64]] = []
    poses = poses_in_free_space(scene, settings, random)
    for _, pose in zip(range(settings.attempts * count), poses, strict=False):
        forward = pose.matrix()[:3, 0]
        if any(
            math.dist(pose.position_m, other.pose.position_m) < settings.apart_m
            and vector_angle_deg(forward, other_forward) < settings.apart_deg
            for other, other_forward in zip(chosen, forwards, strict=True)
        ):
            continue
        depth = scene.depth_m(pose)
        # NaN is nearer than the near plane.
        if not (depth >= settings.nearest_m).all():
            continue
        if len(scene.seen(pose, settings.cover)) < settings.objects:
            continue
        if scene.filled(pose) < settings.filled:
            continue
        chosen.append(CameraView(pose=pose))
        forwards.append(forward)
        if len(chosen) == count:
            break
    return chosen
