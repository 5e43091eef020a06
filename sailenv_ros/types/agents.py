"""Description of an agent: a named camera with a size, a rate, views and a way to be moved.

`AgentSpec` is what a client asks for and what the simulator reports; `AgentPose` answers where
an agent is. Both travel between `simulation.py` and every client of it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.types.camera import CameraIntrinsics, require_fitting
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.look_at import LookAt
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.rigid_body import STEPS_PER_SECOND
from sailenv_ros.types.rigs import (
    RigCamera,
    body_of,
    checked_agent_name,
    checked_cameras,
    checked_extrinsics,
    rectified_baseline_m,
)
from sailenv_ros.types.validation import Bounds, checked_flag, is_finite_number
from sailenv_ros.types.views import FIVE_VIEWS, RENDERED_VIEWS, checked_views

__all__ = [
    "MAX_AGENTS",
    "MAX_RATE_HZ",
    "RATE",
    "WAITED_RATE",
    "AgentPose",
    "AgentSpec",
    "due_steps",
    "stereo_baseline_m",
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
        A ROS name: a lower-case letter, then letters, digits, underscores; at most 63. Of a camera
        of a rig: that of the agent, a slash, its own.
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
        Where it starts when it does not follow; None means at the mover. In the frame of its
        carrier, if it has one.
    carrier : str
        Name of an object that carries it, such as a link of a robot, or of a frame upon a link;
        empty for none.
    look_at : LookAt or None
        What it faces: from the start on in what is registered, now in what is announced.
    cameras : mapping of str to RigCamera, or None
        Makes it a rig: more cameras on its body, by their names. In what is announced they are
        agents of their own, and this is None.
    extrinsics : Pose or None
        Of a camera of a rig: pose of its body in the frame of the agent's body; else None.
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
    cameras: Mapping[str, RigCamera] | None = field(default=None, hash=False)
    extrinsics: Pose | None = None
    carrier: str = ""

    def __post_init__(self) -> None:
        checked_agent_name(self.name, carried=self.extrinsics is not None)
        object.__setattr__(self, "views", checked_views(self.views, supported=RENDERED_VIEWS))
        RATE.number("rate_hz", self.rate_hz)
        checked_flag("following", self.following)
        if self.carrier:
            self._require_held()
        near = self.intrinsics.near_m
        if not (is_finite_number(self.depth_range_m) and self.depth_range_m > near):
            raise InvalidRequest(
                "depth_range_m", self.depth_range_m, f"a number above near_m = {near:g} [m]"
            )
        PictureSettings.checked("picture", self.picture)
        require_fitting(self.intrinsics, self.picture)
        if self.extrinsics is not None:
            self._require_carried()
        if self.cameras is not None:
            object.__setattr__(self, "cameras", checked_cameras(self.cameras))
            _ = self.camera_specs  # each is checked as it is made

    @property
    def body(self) -> str:
        """Name of the agent that carries this camera of a rig; empty if it is none."""
        return body_of(self.name)

    @property
    def camera_specs(self) -> tuple[AgentSpec, ...]:
        """The cameras of a rig as agents of their own, at the rig's rate; empty if it is none."""
        return tuple(
            AgentSpec(
                name=f"{self.name}/{name}",
                intrinsics=camera.intrinsics,
                depth_range_m=camera.depth_range_m,
                rate_hz=self.rate_hz,
                views=camera.views,
                picture=camera.picture,
                extrinsics=camera.extrinsics,
            )
            for name, camera in (self.cameras or {}).items()
        )

    def as_camera(self) -> RigCamera:
        """Return this camera of a rig as the rig's description has it."""
        return RigCamera(
            intrinsics=self.intrinsics,
            extrinsics=checked_extrinsics(self.extrinsics),
            views=self.views,
            depth_range_m=self.depth_range_m,
            picture=self.picture,
        )

    def _require_held(self) -> None:
        """Refuse what an object carries and a mover, or a look-at constraint, moves too."""
        for what in ("mover", "look_at", "extrinsics"):
            if getattr(self, what):
                accepted = f"left out: {self.name!r} goes where {self.carrier!r} goes"
                raise InvalidRequest(what, getattr(self, what), accepted)
        object.__setattr__(self, "following", False)
        object.__setattr__(self, "pose", self.pose or Pose())

    def _require_carried(self) -> None:
        """Refuse a camera of a rig that would go or look somewhere else than its body does."""
        checked_extrinsics(self.extrinsics)
        for what in ("mover", "pose", "look_at", "cameras"):
            if getattr(self, what):
                accepted = f"left out: {self.name!r} goes where {self.body!r} goes"
                raise InvalidRequest(what, getattr(self, what), accepted)
        if not self.following:
            raise InvalidRequest("following", False, f"true: {self.name!r} is carried by its agent")


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


def stereo_baseline_m(spec: AgentSpec, agents: Iterable[AgentSpec]) -> float:
    """Return how far a camera of a rig is to the right of the rig's first camera [m].

    Parameters
    ----------
    spec : AgentSpec
    agents : iterable of AgentSpec
        As announced.

    Returns
    -------
    baseline_m : float
        0 where the two are no rectified pair of equal size, focal lengths and axis.
    """
    first = next((one for one in agents if one.body and one.body == spec.body), spec)
    if first.extrinsics is None or spec.extrinsics is None or first.name == spec.name:
        return 0.0
    one, other = first.intrinsics, spec.intrinsics
    if (one.width, one.height) != (other.width, other.height) or (one.K != other.K).any():
        return 0.0
    return rectified_baseline_m(first.extrinsics, spec.extrinsics) or 0.0


def due_steps(rate_hz: float, count: int) -> list[int]:
    """Return the physics steps at which an agent's frames fall due, from 0 on."""
    # A step late rather than early, as the streams of a simulation do it.
    return [math.ceil(number * STEPS_PER_SECOND / rate_hz - 1e-9) for number in range(count)]
