"""Rigs: several cameras on one body, with known extrinsics, that see one instant.

The body is an agent; each camera is an agent of its own, called ``<agent>/<camera>``, whose place
is where the body carries it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import Pose, invert
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.validation import IDENTIFIER
from sailenv_ros.types.views import FIVE_VIEWS

__all__ = [
    "RigCamera",
    "body_of",
    "camera_of",
    "checked_agent_name",
    "checked_cameras",
    "checked_extrinsics",
]

_ONE_NAME = (
    "a lower-case letter, then lower-case letters, digits or underscores, at most 63"  # IDENTIFIER
)

_RECTIFIED = 1e-6
"""Differences of axes and offsets [m] below which a pair counts as rectified."""


@dataclass(frozen=True, kw_only=True)
class RigCamera:
    """One camera of a rig.

    Attributes
    ----------
    intrinsics : CameraIntrinsics
    extrinsics : Pose
        Pose of the camera's body (x forward, y left, z up) in the frame of the agent's body, which
        has the same axes.
    views : tuple of str
        Views of its frames unless a request names others.
    depth_range_m : float
        Depth that the 8-bit depth picture shows as black [m], more than the near plane.
    picture : PictureSettings
    """

    intrinsics: CameraIntrinsics = field(default_factory=CameraIntrinsics)
    extrinsics: Pose = field(default_factory=Pose)
    views: tuple[str, ...] = FIVE_VIEWS
    depth_range_m: float = 10.0
    picture: PictureSettings = field(default_factory=PictureSettings)

    def __post_init__(self) -> None:
        checked_extrinsics(self.extrinsics)


def checked_extrinsics(value: object) -> Pose:
    """Return the pose of a camera on its body.

    Raises
    ------
    InvalidRequest
    """
    if not isinstance(value, Pose):
        accepted = "a sailenv_ros.Pose: the camera's, in the frame of the agent's body"
        raise InvalidRequest("extrinsics", value, accepted)
    return value


def rectified_baseline_m(left: Pose, right: Pose) -> float | None:
    """Return how far one camera is to the right of another [m]; None if they are not rectified.

    They are if their axes are parallel and one is beside the other, both to 10⁻⁶.

    Parameters
    ----------
    left, right : Pose
        Of the cameras' bodies, both in one frame.
    """
    left_from_right = invert(left.matrix()) @ right.matrix()
    forward_m, left_m, up_m = left_from_right[:3, 3].tolist()
    turned = float(np.abs(left_from_right[:3, :3] - np.eye(3)).max())
    if max(turned, abs(forward_m), abs(up_m)) > _RECTIFIED:
        return None
    return -float(left_m)


def body_of(name: str) -> str:
    """Return the agent that carries a camera of a rig; empty if the name is an agent's own."""
    body, slash, _ = name.partition("/")
    return body if slash else ""


def camera_of(name: str) -> str:
    """Return a camera's name within its rig; empty if the name is an agent's own."""
    return name.partition("/")[2]


def checked_agent_name(name: object, *, carried: bool) -> str:
    """Return the name of an agent, or, with `carried`, of a camera of a rig.

    Raises
    ------
    InvalidRequest
    """
    parts = name.split("/") if isinstance(name, str) else []
    if (
        isinstance(name, str)
        and len(parts) == 1 + carried
        and all(map(IDENTIFIER.fullmatch, parts))
    ):
        return name
    if carried:
        accepted = f"<agent>/<camera>, as it has extrinsics; each of both {_ONE_NAME}"
        raise InvalidRequest("name of the camera", name, accepted)
    raise InvalidRequest("name of the agent", name, _ONE_NAME)


def checked_cameras(cameras: object) -> dict[str, RigCamera]:
    """Return the cameras of a rig by their names, as a mapping of its own.

    Raises
    ------
    InvalidRequest
        If there are none, or one has no name that a topic can have, or is no `RigCamera`.
    """
    if not isinstance(cameras, Mapping) or not cameras:
        accepted = "at least one RigCamera by its name; None for an agent that is no rig"
        raise InvalidRequest("cameras", cameras, accepted)
    for name, camera in cameras.items():
        if not isinstance(name, str) or not IDENTIFIER.fullmatch(name):
            raise InvalidRequest("name of the camera", name, _ONE_NAME)
        if not isinstance(camera, RigCamera):
            raise InvalidRequest(f"camera {name!r}", camera, "a sailenv_ros.RigCamera")
    return dict(cameras)
