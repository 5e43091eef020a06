"""The blocking methods about what moves of itself or is driven; part of `Requests`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal

from numpy.typing import ArrayLike

from sailenv_ros.geometry import Pose
from sailenv_ros.simulation.calls import Calls

__all__ = ["MotionCalls"]


class MotionCalls(Calls):
    """The requests of `MotionRequests`."""

    def attach_behaviour(
        self,
        obj: int | str,
        type_: str,
        parameters: Mapping[str, Any] | None = None,
        *,
        timeout_s: float = 30.0,
    ) -> None:
        """Let an object, named by id or name, move of itself in one more way, from now on."""
        self._ask("attach_behaviour", timeout_s, obj, type_, parameters)

    def detach_behaviours(self, obj: int | str, *, timeout_s: float = 30.0) -> None:
        """End everything that makes an object move of itself; its speed remains."""
        self._ask("detach_behaviours", timeout_s, obj)

    def set_mover_controller(
        self, mover: str, controller: Literal["waypoint", "rigidbody"], *, timeout_s: float = 30.0
    ) -> None:
        """Choose what drives a mover; the empty name means the scene's first."""
        self._ask("set_mover_controller", timeout_s, mover, controller)

    def drive_mover(
        self,
        mover: str = "",
        *,
        linear_m_s: ArrayLike = (0.0, 0.0, 0.0),
        angular_rad_s: ArrayLike = (0.0, 0.0, 0.0),
        timeout_s: float = 30.0,
    ) -> None:
        """Have a mover walk for half a simulated second, unless another command comes.

        Forward and left along the ground, up along the world's z [m/s]; pitch (down is positive)
        and yaw (left is positive) [rad/s]. What it meets stops it.
        """
        self._ask(
            "drive_mover", timeout_s, mover, linear_m_s=linear_m_s, angular_rad_s=angular_rad_s
        )

    def turn_mover(
        self,
        mover: str = "",
        *,
        pitch_rad: float = 0.0,
        yaw_rad: float = 0.0,
        timeout_s: float = 30.0,
    ) -> None:
        """Turn a mover at once: pitch (down is positive), yaw (left is positive) [rad]."""
        self._ask("turn_mover", timeout_s, mover, pitch_rad=pitch_rad, yaw_rad=yaw_rad)

    def set_waypoints(
        self,
        waypoints: Sequence[Pose],
        *,
        mover: str = "",
        append: bool = False,
        total_time_s: float | None = None,
        loop: bool | None = None,
        timeout_s: float = 30.0,
    ) -> None:
        """Give a mover another track; `scene_info` tells the one that it has.

        Parameters
        ----------
        waypoints : sequence of Pose
            At most 1000; none leaves it where it is.
        mover : str
            The empty name means the scene's first.
        append : bool
            True adds them to those that it has.
        total_time_s : float or None
            Time to run through all of them once [s]; None leaves it.
        loop : bool or None
            True if the last leads on to the first; None leaves it.

        Notes
        -----
        What follows the mover moves with it, and flow shows that as motion. It goes on from the
        leg, and the part of it, that it had reached.
        """
        self._ask(
            "set_waypoints",
            timeout_s,
            waypoints,
            mover=mover,
            append=append,
            total_time_s=total_time_s,
            loop=loop,
        )

    def mover_pose(self, mover: str = "", *, timeout_s: float = 30.0) -> Pose:
        """Say where a mover is; the empty name means the scene's first."""
        result: Pose = self._ask("mover_pose", timeout_s, mover)
        return result
