"""Measurements of the sensors on robots: laser scanners and inertial sensors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.geometry import Pose

__all__ = ["InertialMeasurement", "LaserScan"]

Vector3 = tuple[float, float, float]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class LaserScan:
    """One turn of a laser scanner, at one instant.

    Attributes
    ----------
    pose : Pose
        Of the sensor, world frame: rays lie in its xy plane.
    angle_min_rad, angle_increment_rad : float
        Of the first ray, about z from x, and from each to the next.
    range_min_m, range_max_m : float
    ranges_m : (R,) float64
        Infinite where nothing is met.
    sim_time_ns : int
    """

    pose: Pose
    angle_min_rad: float
    angle_increment_rad: float
    range_min_m: float
    range_max_m: float
    ranges_m: NDArray[np.float64]
    sim_time_ns: int

    def points_m(self) -> NDArray[np.float64]:
        """Return (N, 3) float64: the points that were met, in the sensor's frame [m]."""
        angles = self.angle_min_rad + self.angle_increment_rad * np.arange(len(self.ranges_m))
        met = np.isfinite(self.ranges_m)
        ways = np.stack([np.cos(angles), np.sin(angles), np.zeros(len(angles))], axis=1)
        return np.asarray(self.ranges_m[met, None] * ways[met])


@dataclass(frozen=True, slots=True, kw_only=True)
class InertialMeasurement:
    """A measurement of an inertial sensor, in its own axes.

    Attributes
    ----------
    orientation_xyzw : (4,) tuple of float
        Of the sensor in the world.
    angular_rad_s : (3,) tuple of float
    acceleration_m_s2 : (3,) tuple of float
        Proper acceleration: at rest it points up, with 9.81.
    sim_time_ns : int
    """

    orientation_xyzw: tuple[float, float, float, float]
    angular_rad_s: Vector3
    acceleration_m_s2: Vector3
    sim_time_ns: int
