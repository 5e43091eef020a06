"""`free_view`: cameras as somebody would carry them, who walks through free space."""

from __future__ import annotations

import itertools
import math
import operator
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from pydantic import Field

from sailenv_ros.authoring.viewpoints.view_scene import (
    CameraView,
    RuleSettings,
    ViewScene,
    camera_rule,
)
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.space.free_space import BodySize
from sailenv_ros.types.geometry import Pose

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


class _Look(NamedTuple):
    """A place to look from [m], and whither [deg]."""

    position_m: tuple[float, float, float]
    pitch_deg: float
    yaw_deg: float

    @property
    def pose(self) -> Pose:
        """Of the camera."""
        return Pose.from_rpy_deg(self.position_m, (0.0, self.pitch_deg, self.yaw_deg))

    @property
    def forward(self) -> tuple[float, float, float]:
        """Unit vector along the optical axis."""
        pitch, yaw = math.radians(self.pitch_deg), math.radians(self.yaw_deg)
        level = math.cos(pitch)
        return level * math.cos(yaw), level * math.sin(yaw), -math.sin(pitch)


def poses_in_free_space(
    scene: ViewScene, settings: FreeView, random: np.random.Generator
) -> Iterator[Pose]:
    """Yield random poses at places where a body of that height and clearance can stand.

    Raises
    ------
    InvalidRequest
        If a range ends before it begins, or the camera is not above the floor.
    """
    return (look.pose for look in _looks_in_free_space(scene, settings, random))


def _looks_in_free_space(
    scene: ViewScene, settings: FreeView, random: np.random.Generator
) -> Iterator[_Look]:
    """Yield random looks; see `poses_in_free_space`.

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
        yield _Look((x, y, floor + height), pitch, yaw)


@camera_rule("free_view", FreeView)
def free_view(
    scene: ViewScene, settings: FreeView, count: int, random: np.random.Generator
) -> list[CameraView]:
    """Look from free space at a height, nothing too near, several objects in view."""
    chosen: list[CameraView] = []
    taken: list[tuple[tuple[float, float, float], tuple[float, float, float]]] = []
    # Where a room is nearly full most are beside one that is chosen: these are to cost little.
    most_alike = math.cos(math.radians(settings.apart_deg)) if settings.apart_deg else math.inf
    looks = _looks_in_free_space(scene, settings, random)
    for look in itertools.islice(looks, settings.attempts * count):
        forward = look.forward
        if any(
            math.dist(look.position_m, position) < settings.apart_m
            and sum(map(operator.mul, forward, other)) > most_alike
            for position, other in taken
        ):
            continue
        pose = look.pose
        depth = scene.depth_m(pose)
        # NaN is nearer than the near plane.
        if not (depth >= settings.nearest_m).all():
            continue
        if len(scene.seen(pose, settings.cover)) < settings.objects:
            continue
        if scene.filled(pose) < settings.filled:
            continue
        chosen.append(CameraView(pose=pose))
        taken.append((look.position_m, forward))
        if len(chosen) == count:
            break
    return chosen
