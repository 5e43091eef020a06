"""Operations on movers, which carry the agents that follow them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Literal

from numpy.typing import ArrayLike

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.simulation.operations import argument_checks as check
from sailenv_ros.simulation.operations.operation import Caller, operation
from sailenv_ros.simulation.operations.targets import HasWorld
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.scene_info import MoverInfo
from sailenv_ros.types.validation import Bounds, vector

if TYPE_CHECKING:
    from sailenv_ros.world.mover import Mover

__all__ = ["MoverOperations"]

MAX_WAYPOINTS = 1000
MAX_TIME_S = 1e6


@contextmanager
def _telling_what_is_faced(core: HasWorld, name: str) -> Iterator[Mover]:
    """Announce the scene if what is done to a mover ends what it faces."""
    mover = core.world.mover(name)
    before = mover.gaze
    yield mover
    if mover.gaze is not before:
        core.announce()


_TRACK_TIME = Bounds(above=0.0, most=MAX_TIME_S, unit="s")


class MoverOperations(Caller):
    """Movers. The empty name means the scene's first."""

    @property
    def movers(self) -> dict[str, MoverInfo]:
        """The movers by their names, with what drives them and their tracks; the first first."""
        return {mover.name: mover for mover in self.info.movers}

    @operation(controller=check.text, mover=check.text)
    @staticmethod
    def set_mover_controller(
        core: HasWorld, controller: Literal["waypoint", "rigidbody"], mover: str = ""
    ) -> None:
        """Choose what drives a mover.

        Parameters
        ----------
        controller : {'waypoint', 'rigidbody'}
            Its waypoints, from where they were interrupted; or commands and set poses.
        mover : str
        """
        found = core.world.mover(mover)
        before = found.controller
        found.control(controller, core.world.sim_time_ns)
        if found.controller != before:
            core.announce()

    @operation(linear_m_s=vector, angular_rad_s=vector, mover=check.text)
    @staticmethod
    def drive_mover(
        core: HasWorld,
        linear_m_s: ArrayLike = (0.0, 0.0, 0.0),
        angular_rad_s: ArrayLike = (0.0, 0.0, 0.0),
        mover: str = "",
    ) -> None:
        """Have a mover walk for half a simulated second, unless another command comes.

        What it meets stops it.

        Parameters
        ----------
        linear_m_s : (3,) array-like
            Forward and left along the ground, up along the world's z, each within 5 [m/s].
        angular_rad_s : (3,) array-like
            0, pitch (down is positive), yaw (left is positive), each within 5 [rad/s].
        mover : str
            Its controller must be ``rigidbody``.
        """
        with _telling_what_is_faced(core, mover):
            core.world.drive(mover, linear_m_s, angular_rad_s)

    @operation(pitch_rad=check.number, yaw_rad=check.number, mover=check.text)
    @staticmethod
    def turn_mover(
        core: HasWorld, pitch_rad: float = 0.0, yaw_rad: float = 0.0, mover: str = ""
    ) -> None:
        """Turn a mover at once: pitch (down is positive), yaw (left is positive) [rad]."""
        with _telling_what_is_faced(core, mover) as found:
            found.turn(pitch_rad, yaw_rad)

    @operation(
        waypoints=check.track, mover=check.text, total_time_s=check.optional(_TRACK_TIME.number)
    )
    @staticmethod
    def set_waypoints(
        core: HasWorld,
        waypoints: Sequence[Pose | tuple[ArrayLike, ArrayLike]],
        mover: str = "",
        *,
        append: bool = False,
        total_time_s: float | None = None,
        loop: bool | None = None,
    ) -> None:
        """Set a mover's track; `movers` has the present one.

        Parameters
        ----------
        waypoints : sequence of Pose, or of pairs of a position and a rotation
            [m] and roll, pitch, yaw [deg]; at most 1000. None of them leaves it where it is.
        mover : str
        append : bool
            True adds them to those that it has.
        total_time_s : float or None
            Time to run through all of them once [s]; None leaves it as it is.
        loop : bool or None
            True if the last leads on to the first; None leaves it as it is.

        Notes
        -----
        What follows the mover moves with it, and flow shows that as motion. It continues from the
        leg, and the part of it, that it had reached.
        """
        found = core.world.mover(mover)
        poses = check.track("waypoints", waypoints)
        poses = (*found.waypoints, *poses) if append else poses
        if len(poses) > MAX_WAYPOINTS:
            raise InvalidRequest("number of waypoints", len(poses), f"at most {MAX_WAYPOINTS}")
        found.lead(
            poses,
            total_time_s=found.total_time_s if total_time_s is None else total_time_s,
            loop=found.loop if loop is None else loop,
            time_ns=core.world.sim_time_ns,
        )
        core.announce()

    def add_waypoint(
        self, position: ArrayLike, rotation: ArrayLike = (0.0, 0.0, 0.0), mover: str = ""
    ) -> None:
        """Lengthen a mover's track by a position [m] and roll, pitch, yaw [deg]."""
        waypoint: Any = (position, rotation)
        self.set_waypoints([waypoint], mover, append=True)

    @operation(mover=check.text)
    @staticmethod
    def get_mover_pose(core: HasWorld, mover: str = "") -> Pose:
        """Return where a mover is (x forward, z up, world frame)."""
        return core.world.mover(mover).pose_at(core.world.sim_time_ns)
