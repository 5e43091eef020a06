"""The scene as the page is told it, as typed dictionaries; `scene_json` fills them.

Declared once for both sides, see `messages`. Positions are in metres, angles in degrees.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from typing_extensions import TypedDict

from sailenv_ros.types.lights import LightType
from sailenv_ros.types.scene_info import TimeMode

__all__ = [
    "AgentNews",
    "CategoryNews",
    "EnvironmentNews",
    "InstanceNews",
    "LensValues",
    "LightNews",
    "LookAtNews",
    "MoverNews",
    "PersonLines",
    "PoseValues",
    "SceneMessage",
    "Segment",
    "Vector3",
]

Vector3 = tuple[float, float, float]

Segment = tuple[float, float, float, float]
"""Ends u, v, u, v of a straight piece of a line [px]."""

PersonLines = tuple[int, list[Segment], list[tuple[float, float, bool]]]
"""Id of a person, lines between its keypoints, and those in view: u, v, whether it is seen."""


class PoseValues(TypedDict):
    """A pose: position [m] and roll, pitch, yaw [deg]."""

    position: Vector3
    rpy_deg: Vector3


class CategoryNews(TypedDict):
    """A category: its id in the category view, its name, its colour in 0 to 255."""

    id: int
    name: str
    colour: tuple[int, int, int]


class InstanceNews(TypedDict):
    """An object, or a part of one; `painted` lists the materials that it was given."""

    id: int
    name: str
    asset: str
    category_id: int
    category: str
    static: bool
    moves: bool
    materials: list[str]
    painted: list[Mapping[str, Any]]
    parent: int
    is_part: bool


class LightNews(TypedDict):
    """A light; see `sailenv_ros.types.lights.Light`."""

    name: str
    type: LightType
    intensity: float
    indirect_multiplier: float
    range_m: float
    colour: Vector3
    position_m: Vector3
    direction: Vector3


class EnvironmentNews(TypedDict):
    """The surroundings; see `sailenv_ros.types.lights.Environment`."""

    ambient: Vector3
    background: str
    background_colour: Vector3
    sky_map: str
    sky_rotation: float
    sky_blend: bool
    outside_factor: float
    sky_share: float
    exposure: float


class LookAtNews(TypedDict):
    """A faced point, of an object where one is named [m]."""

    object: str
    point: Vector3


class AgentNews(TypedDict):
    """An agent: its camera, its picture, what it follows and faces."""

    name: str
    width: int
    height: int
    fov_deg: float
    rate_hz: float
    following: bool
    mover: str
    picture: dict[str, float | bool | str]
    look_at: LookAtNews | None


class LensValues(TypedDict):
    """A lens: lengths in px, coefficients by name, how far from the axis it sees.

    The angle is null for parallel rays.
    """

    model: str
    fx: float
    fy: float
    cx: float
    cy: float
    coefficients: list[tuple[str, float]]
    max_angle_deg: float | None


class MoverNews(TypedDict):
    """A mover: its driver and its track."""

    name: str
    controller: Literal["waypoint", "rigidbody"]
    waypoints: list[PoseValues]
    total_time_s: float
    loop: bool
    is_body: bool


class SceneMessage(TypedDict):
    """The scene, sent after each change of it."""

    type: Literal["scene"]
    scene: str
    scenes: list[str]
    epoch: int
    revision: int
    mode: TimeMode
    paused: bool
    real_time_factor: float
    seed: int
    renderer: str
    categories: list[CategoryNews]
    instances: list[InstanceNews]
    spawnables: list[str]
    lights: list[LightNews]
    environment: EnvironmentNews
    agents: list[AgentNews]
    movers: list[MoverNews]
