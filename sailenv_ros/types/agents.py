"""Description of an agent: a named camera with a size, a rate, views and a way to be moved.

`AgentSpec` is what a client asks for and what the simulator reports; `AgentPose` answers where
an agent is. Both travel between `simulation.py` and every client of it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.look_at import LookAt
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.rigid_body import STEPS_PER_SECOND
from sailenv_ros.types.validation import (
    IDENTIFIER,
    Bounds,
    checked_flag,
    is_finite_number,
)
from sailenv_ros.types.views import FIVE_VIEWS, RENDERED_VIEWS, checked_views

__all__ = [
    "MAX_AGENTS",
    "MAX_RATE_HZ",
    "RATE",
    "WAITED_RATE",
    "AgentPose",
    "AgentSpec",
    "due_steps",
]

MAX_AGENTS = 16
MAX_RATE_HZ = float(STEPS_PER_SECOND)


RATE = Bounds(least=0.0, most=MAX_RATE_HZ, unit="Hz")
"""Rates of streamed frames."""

WAITED_RATE = Bounds(above=0.0, most=MAX_RATE_HZ, unit="Hz")
"""Rates of frames that somebody waits for."""


@dataclass(frozen=True, kw_only=True)
class AgentSpec:
    """One agent.

    Attributes
    ----------
    name : str
        A ROS name: a lower-case letter, then letters, digits, underscores; at most 63.
    intrinsics : CameraIntrinsics
    depth_range_m : float
        Depth that the 8-bit depth picture shows as black [m], more than the near plane.
    rate_hz : float
        Frames per second of simulated time that are streamed, 0 to 240; 0 = on request only.
    views : tuple of str
        Views of a frame unless a request names others.
    following : bool
        True if the agent takes over its mover's pose.
    mover : str
        The mover it follows; empty means the scene's first.
    picture : PictureSettings
        What is done to its pictures, and to nothing else.
    pose : Pose or None
        Where it starts when it does not follow; None means at the mover.
    look_at : LookAt or None
        What it faces: from the start on in what is registered, now in what is announced.
    """

    name: str
    intrinsics: CameraIntrinsics = field(default_factory=CameraIntrinsics)
    depth_range_m: float = 10.0
    rate_hz: float = 30.0
    views: tuple[str, ...] = FIVE_VIEWS
    following: bool = True
    mover: str = ""
    pose: Pose | None = None
    picture: PictureSettings = field(default_factory=PictureSettings)
    look_at: LookAt | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not IDENTIFIER.fullmatch(self.name):
            raise InvalidRequest(
                "name of the agent",
                self.name,
                "a lower-case letter, then lower-case letters, digits or underscores, at most 63",
            )
        object.__setattr__(self, "views", checked_views(self.views, supported=RENDERED_VIEWS))
        RATE.number("rate_hz", self.rate_hz)
        checked_flag("following", self.following)
        near = self.intrinsics.near_m
        if not (is_finite_number(self.depth_range_m) and self.depth_range_m > near):
            raise InvalidRequest(
                "depth_range_m", self.depth_range_m, f"a number above near_m = {near:g} [m]"
            )
        PictureSettings.checked("picture", self.picture)
        self.picture.require_drawable(self.intrinsics.width, self.intrinsics.height)


@dataclass(frozen=True, slots=True, kw_only=True)
class AgentPose:
    """Pose of an agent at an instant.

    Attributes
    ----------
    pose : Pose
        The camera's body (x forward, y left, z up) in the world frame.
    following : bool
    mover : str
        Name of the mover it follows, or would follow.
    sim_time_ns : int
        The instant it was read at [ns].
    """

    pose: Pose
    following: bool
    mover: str
    sim_time_ns: int


def due_steps(rate_hz: float, count: int) -> list[int]:
    """Return the physics steps at which an agent's frames fall due, from 0 on."""
    # A step late rather than early, as the streams of a simulation do it.
    return [math.ceil(number * STEPS_PER_SECOND / rate_hz - 1e-9) for number in range(count)]
