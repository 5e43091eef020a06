"""The mover: the track that agents follow.

While its waypoints drive it, its pose is a pure function of the simulated time it has run, so
reading it twice gives the same bytes. Once it is put somewhere by hand it stays there until a
command moves it (`world.collision_proxy` says how far) or the waypoints are given control again.
One that is a rigid body (`world.mover_body`) is where the engine has brought it.
"""

from __future__ import annotations

import math
from typing import Literal, get_args

from sailenv_ros.errors import InvalidState, UnknownName
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.look_at import LookAt
from sailenv_ros.types.rigid_body import RigidBody
from sailenv_ros.types.validation import vector
from sailenv_ros.world.look_at_solver import LookAtSolver
from sailenv_ros.world.mover_body import Motion, MoverBody
from sailenv_ros.world.mover_motion import MoverCommand, WaypointTrack, turned

__all__ = [
    "COMMAND_LASTS_NS",
    "Controller",
    "Mover",
]

Controller = Literal["waypoint", "rigidbody"]

COMMAND_LASTS_NS = 500_000_000
"""Simulated time after which a command that was not given again ends [ns]."""


class Mover:
    """A pose that waypoints or commands move.

    Parameters
    ----------
    name : str
    start : Pose
        Where it stands while nothing drives it.
    track : WaypointTrack or None
    controller : {'waypoint', 'rigidbody'}
        ``waypoint`` without a track stays at the start.
    total_time_s, loop
        Of the track that it may be given, if it has none.
    begins_as : (RigidBody, (linear, angular)) or None
        What it is in the engine from the start on, and its velocities then, world frame [m/s],
        [rad/s]; None if it is no rigid body.
    """

    def __init__(
        self,
        *,
        name: str,
        start: Pose,
        track: WaypointTrack | None,
        controller: Controller,
        total_time_s: float = 30.0,
        loop: bool = True,
        begins_as: tuple[RigidBody, Motion] | None = None,
    ) -> None:
        self.name = name
        self.begins_as = begins_as
        self._body: MoverBody | None = None
        self._track = track
        self._total_time_s = total_time_s if track is None else track.total_time_s
        self._loop = loop if track is None else track.loop
        self._controller: Controller = controller
        self._held = start
        self._run_ns = 0
        self._since_ns = 0
        self._command: MoverCommand | None = None
        self._command_ends_ns = 0
        self._gaze: LookAtSolver | None = None

    @property
    def track(self) -> WaypointTrack | None:
        """Track through its waypoints; None if there are none."""
        return self._track

    @property
    def waypoints(self) -> tuple[Pose, ...]:
        """The poses of its track; none if it has no track."""
        return () if self._track is None else self._track.waypoints

    @property
    def total_time_s(self) -> float:
        """Time to run through all the waypoints once [s]."""
        return self._total_time_s

    @property
    def loop(self) -> bool:
        """True if the last waypoint leads on to the first."""
        return self._loop

    @property
    def controller(self) -> Controller:
        """The controller that drives it."""
        return self._controller

    def pose_at(self, time_ns: int) -> Pose:
        """Return the pose at a simulated time not before the last change [ns].

        What it faces is where it is now.
        """
        own = self.own_pose_at(time_ns)
        return own if self._gaze is None else self._gaze.turned(own)

    def own_pose_at(self, time_ns: int) -> Pose:
        """Return the pose that it would have if it faced nothing."""
        if self._stands or self._track is None:
            return self._held
        return self._track.pose_at(self._ran_ns(time_ns) * 1e-9)

    @property
    def gaze(self) -> LookAtSolver | None:
        """Solver of its gaze; None if it looks at nothing."""
        return self._gaze

    @property
    def look_at(self) -> LookAt | None:
        """Its look-at target as data; None if there is none."""
        return None if self._gaze is None else self._gaze.described()

    def face(self, gaze: LookAtSolver | None, time_ns: int) -> None:
        """Face something from now on; without anything, waypoints or commands alone turn it.

        One that stands stays turned as it is.
        """
        if gaze is None and self._gaze is not None and self._stands:
            self._turn_to(self.pose_at(time_ns))
        self._gaze = gaze

    @property
    def body(self) -> MoverBody | None:
        """Its rigid body in the engine; None if it has none."""
        return self._body

    def set_body(self, body: MoverBody | None, time_ns: int) -> None:
        """Let a body carry it from now on, or none any more: it stays where it is then."""
        self.control("rigidbody", time_ns)
        self._body = body

    def require_untracked(self) -> None:
        """Refuse to make a rigid body of what waypoints drive.

        Raises
        ------
        InvalidState
        """
        if self._controller == "waypoint" and self._track is not None:
            raise InvalidState(
                f"waypoints drive mover {self.name!r}; to make it a body, make its controller "
                "'rigidbody' by set_mover_controller"
            )

    def require_body(self) -> MoverBody:
        """Return what it is in the engine.

        Raises
        ------
        InvalidState
            If it is no rigid body.
        """
        if self._body is None:
            raise InvalidState(
                f"mover {self.name!r} is not a body; make it one by set_mover_body, or by body: "
                "in the scene file"
            )
        return self._body

    @property
    def _stands(self) -> bool:
        return self._controller == "rigidbody" or self._track is None

    def hold(self, pose: Pose, time_ns: int) -> None:
        """Put it somewhere and keep it there: waypoints no longer drive it; a body is stopped."""
        self.control("rigidbody", time_ns)
        self._held = pose
        if self._body is not None:
            self._body.put(pose)

    def moved(self, pose: Pose) -> None:
        """Take note of where a command, or the engine, has brought it."""
        self._held = pose

    def _turn_to(self, pose: Pose) -> None:
        self._held = pose
        if self._body is not None:
            self._body.turn(pose)

    def turn(self, pitch_rad: float, yaw_rad: float) -> None:
        """Turn it where it stands: pitch down, yaw to the left [rad]; it faces nothing then.

        Raises
        ------
        InvalidState
            If its waypoints drive it.
        InvalidRequest
            If an angle is not from -π to π.
        """
        if self._controller != "rigidbody":
            raise InvalidState(
                f"waypoints drive mover {self.name!r}; to turn it, make its controller 'rigidbody' "
                "by set_mover_controller"
            )
        given = vector("angles to turn by", (0.0, pitch_rad, yaw_rad), limit=math.pi)
        self.face(None, 0)  # where it stands does not depend on the time
        self._turn_to(turned(self._held, given[1], given[2]))

    def command(self, command: MoverCommand, time_ns: int) -> None:
        """Have it walk, until another command comes or `COMMAND_LASTS_NS` are over.

        One that turns ends what it faces.

        Raises
        ------
        InvalidState
            If its waypoints drive it, or it is a rigid body.
        """
        if self._controller != "rigidbody":
            raise InvalidState(
                f"waypoints drive mover {self.name!r}; to drive it, make its controller "
                "'rigidbody' by set_mover_controller"
            )
        if self._body is not None:
            raise InvalidState(
                f"mover {self.name!r} is a body, which forces move; push it by apply_wrench, or "
                "make it none by set_mover_body"
            )
        if any(command.angular_rad_s):
            self.face(None, time_ns)
        self._command = command
        self._command_ends_ns = time_ns + COMMAND_LASTS_NS

    def command_at(self, time_ns: int) -> MoverCommand | None:
        """Return the command that moves it at a simulated time [ns]; None if it stands still."""
        command = self._command
        if command is None or not command.moves or time_ns >= self._command_ends_ns:
            return None
        return command

    def lead(
        self, waypoints: tuple[Pose, ...], *, total_time_s: float, loop: bool, time_ns: int
    ) -> None:
        """Replace its track; on the leg that it has reached, it is as far as it was.

        Without waypoints it stays where it is.
        """
        track = None
        if waypoints:
            track = WaypointTrack(waypoints=waypoints, total_time_s=total_time_s, loop=loop)
        else:
            self._held = self.pose_at(time_ns)
        self._total_time_s, self._loop = total_time_s, loop
        ran_ns = self._run_ns if self._controller == "rigidbody" else self._ran_ns(time_ns)
        progress = 0.0 if self._track is None else self._track.progress_at(ran_ns * 1e-9)
        self._run_ns = 0
        if track is not None and track.legs:
            self._run_ns = round(progress / track.legs * track.total_time_s * 1e9)
        self._since_ns, self._track = time_ns, track

    def control(self, controller: Controller, time_ns: int) -> None:
        """Change what drives it; waypoints continue where they were interrupted.

        Raises
        ------
        UnknownName
            If there is no such controller.
        InvalidState
            If waypoints shall drive a rigid body.
        """
        if controller not in get_args(Controller):
            raise UnknownName("controller", str(controller), get_args(Controller))
        if controller == "waypoint" and self._body is not None:
            raise InvalidState(
                f"mover {self.name!r} is a body, which forces move; make it none by "
                "set_mover_body before waypoints drive it"
            )
        self._command = None
        if controller == self._controller:
            return
        if controller == "rigidbody":
            self._held = self.pose_at(time_ns)
            self._run_ns = self._ran_ns(time_ns)
        else:
            self._since_ns = time_ns
        self._controller = controller

    def _ran_ns(self, time_ns: int) -> int:
        return self._run_ns + time_ns - self._since_ns
