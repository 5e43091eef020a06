"""The mover: the track that agents follow.

While its waypoints drive it, its pose is a pure function of the simulated time it has run, so
reading it twice gives the same bytes. Once it is put somewhere by hand it stays there until the
waypoints are given control again.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from sailenv_ros.geometry import Pose, interpolate

__all__ = ["Mover", "WaypointTrack"]

Controller = Literal["waypoint", "rigidbody"]


@dataclass(frozen=True, slots=True, kw_only=True)
class WaypointTrack:
    """A closed or open track through poses at equal time intervals.

    Attributes
    ----------
    waypoints : tuple of Pose
        At least one.
    total_time_s : float
        Time to run across all the waypoints once [s], above 0.
    loop : bool
        True if the last waypoint leads on to the first, else it stays at the last.
    """

    waypoints: tuple[Pose, ...]
    total_time_s: float
    loop: bool = True

    def pose_at(self, time_s: float) -> Pose:
        """Interpolate: lines between positions, shorter arcs between orientations, equal times."""
        count = len(self.waypoints)
        legs = count if self.loop else count - 1
        if legs < 1 or count == 1:
            return self.waypoints[0]
        progress = time_s / self.total_time_s * legs
        if not self.loop and progress >= legs:
            return self.waypoints[-1]
        leg = int(progress // 1.0)
        first, second = self.waypoints[leg % count], self.waypoints[(leg + 1) % count]
        return interpolate(first, second, progress - leg)


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
    """

    def __init__(
        self, *, name: str, start: Pose, track: WaypointTrack | None, controller: Controller
    ) -> None:
        self.name = name
        self._track = track
        self._controller: Controller = controller
        self._held = start
        self._run_ns = 0
        self._since_ns = 0

    @property
    def track(self) -> WaypointTrack | None:
        """Where waypoints lead it; None if there are none."""
        return self._track

    @property
    def controller(self) -> Controller:
        """What drives it."""
        return self._controller

    def pose_at(self, time_ns: int) -> Pose:
        """Give the pose at a simulated time not before the last change [ns]."""
        if self._controller == "rigidbody" or self._track is None:
            return self._held
        return self._track.pose_at(self._ran_ns(time_ns) * 1e-9)

    def hold(self, pose: Pose, time_ns: int) -> None:
        """Put it somewhere and keep it there: waypoints no longer drive it."""
        self.control("rigidbody", time_ns)
        self._held = pose

    def control(self, controller: Controller, time_ns: int) -> None:
        """Change what drives it; waypoints go on where they were interrupted."""
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
