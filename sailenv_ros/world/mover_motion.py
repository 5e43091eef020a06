"""Motion of a mover: commands of a user, and tracks through waypoints."""

from __future__ import annotations

import math
from dataclasses import dataclass

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.types.geometry import Pose, interpolate
from sailenv_ros.types.validation import vector

__all__ = ["MAX_COMMAND", "MAX_PITCH_DEG", "MoverCommand", "WaypointTrack", "turned"]


MAX_COMMAND = 5.0
"""Fastest that is accepted [m/s], [rad/s]."""

MAX_PITCH_DEG = 89.0


@dataclass(frozen=True, slots=True, kw_only=True)
class MoverCommand:
    """Velocity command of a mover, which walks like a first-person camera.

    Attributes
    ----------
    linear_m_s : (3,) tuple of float
        Forward and left along the ground, up along the world's z, whatever it looks at [m/s].
    angular_rad_s : (3,) tuple of float
        Roll, which is not accepted, pitch (down is positive), yaw (left is positive) [rad/s].

    Raises
    ------
    InvalidRequest
        If a number is not finite or above `MAX_COMMAND`, or it rolls.
    """

    linear_m_s: tuple[float, float, float] = (0.0, 0.0, 0.0)
    angular_rad_s: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        for name in ("linear_m_s", "angular_rad_s"):
            given = vector(f"command's {name}", getattr(self, name), limit=MAX_COMMAND)
            object.__setattr__(self, name, given)
        if self.angular_rad_s[0]:
            accepted = "0: a mover does not roll"
            raise InvalidRequest("command's roll rate", self.angular_rad_s[0], accepted)

    @property
    def moves(self) -> bool:
        """True unless everything is 0."""
        return any((*self.linear_m_s, *self.angular_rad_s))


def turned(pose: Pose, pitch_rad: float, yaw_rad: float) -> Pose:
    """Turn a walker's pose by angles [rad]; it never looks over its zenith or its feet."""
    roll, pitch, yaw = pose.rpy_deg
    pitch = max(-MAX_PITCH_DEG, min(MAX_PITCH_DEG, pitch + math.degrees(pitch_rad)))
    return Pose.from_rpy_deg(pose.position_m, (roll, pitch, yaw + math.degrees(yaw_rad)))


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

    @property
    def legs(self) -> int:
        """Number of legs from one waypoint to the next; 0 for a single one."""
        count = len(self.waypoints)
        return count if self.loop and count > 1 else count - 1

    def pose_at(self, time_s: float) -> Pose:
        """Interpolate: lines between positions, shorter arcs between orientations, equal times."""
        count, legs = len(self.waypoints), self.legs
        if legs < 1:
            return self.waypoints[0]
        progress = time_s / self.total_time_s * legs
        if not self.loop and progress >= legs:
            return self.waypoints[-1]
        leg = int(progress // 1.0)
        first, second = self.waypoints[leg % count], self.waypoints[(leg + 1) % count]
        return interpolate(first, second, progress - leg)

    def progress_at(self, time_s: float) -> float:
        """Return how many legs are behind it; a track that is closed begins at 0 again."""
        if not self.legs:
            return 0.0
        progress = time_s / self.total_time_s * self.legs
        return progress % self.legs if self.loop else min(progress, float(self.legs))
