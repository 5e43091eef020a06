"""Sensors on robots: where they are, and what they measure of the world as it stands."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import UnknownName
from sailenv_ros.postures.limbs import cross
from sailenv_ros.scene.spec_robots import SensorSpec
from sailenv_ros.space.ray_hits import RayCast
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.robot_sensors import InertialMeasurement, LaserScan
from sailenv_ros.world.bullet import STEPS_PER_SECOND
from sailenv_ros.world.jointed_bodies import JointedBody
from sailenv_ros.world.kinematics import composed
from sailenv_ros.world.robot_kinematics import carrier
from sailenv_ros.world.robot_placements import RobotPlacement

__all__ = ["CastRays", "RobotSensors"]

Doubles = NDArray[np.float64]
CastRays = Callable[[Doubles, Doubles], RayCast]

MOST_OWN = 8
"""Surfaces of its own robot that one ray of a scanner passes."""

PASSED_M = 1e-4


class RobotSensors:
    """The sensors of one robot.

    Parameters
    ----------
    placement : RobotPlacement

    Raises
    ------
    UnknownName
        If the link of one is not there.
    """

    def __init__(self, placement: RobotPlacement) -> None:
        self._name = placement.spec.name
        self._sensors: dict[str, tuple[SensorSpec, str, Pose]] = {}
        model = placement.model
        for spec in placement.spec.sensors:
            link, offset = carrier(model, spec.link or model.links[0].name)
            pose = Pose.from_matrix(offset @ spec.pose.matrix())
            self._sensors[spec.name] = spec, link, pose
        self._before: dict[str, Doubles] = {}

    def named(self, kind: str, name: str) -> SensorSpec:
        """Find a sensor; the empty name means the first of its kind.

        Raises
        ------
        UnknownName
        """
        known = {one: spec for one, (spec, _, _) in self._sensors.items() if spec.type == kind}
        if not name and known:
            return next(iter(known.values()))
        if name not in known:
            raise UnknownName(f"{kind} of robot {self._name!r}", name, known)
        return known[name]

    @property
    def mounted(self) -> tuple[tuple[str, str, Pose], ...]:
        """Names of the sensors, the links that carry them, and their poses there."""
        return tuple((name, link, pose) for name, (_, link, pose) in self._sensors.items())

    def pose(self, sensor: str, bodies: Mapping[str, JointedBody]) -> Pose:
        """Return where a sensor is, world frame."""
        _, link, pose = self._sensors[sensor]
        return composed(bodies[link].pose(), pose)

    def before_step(self, bodies: Mapping[str, JointedBody]) -> None:
        """Take note of how inertial sensors move before a step."""
        for name, (spec, _, _) in self._sensors.items():
            if spec.type == "imu":
                self._before[name] = self._velocity(name, bodies)[0]

    def scan(
        self,
        sensor: str,
        bodies: Mapping[str, JointedBody],
        own: Collection[int],
        cast: CastRays,
        sim_time_ns: int,
    ) -> LaserScan:
        """Return what a laser scanner measures; `own` are the ids of its robot's links."""
        spec = self.named("lidar", sensor)
        pose = self.pose(spec.name, bodies)
        whole = spec.field >= 360.0
        span = math.radians(spec.field)
        increment = span / (spec.rays if whole else max(spec.rays - 1, 1))
        angles = -0.5 * span + increment * np.arange(spec.rays)
        matrix = pose.matrix()
        flat = np.stack([np.cos(angles), np.sin(angles), np.zeros(len(angles))], axis=1)
        ways = np.ascontiguousarray(flat @ matrix[:3, :3].T)
        starts = np.repeat(matrix[None, :3, 3], len(ways), axis=0)
        ranges = np.full(len(ways), np.inf)
        passed = np.full(len(ways), spec.near)
        waiting = np.arange(len(ways))
        links = np.array(sorted(own), np.uint16)
        for _ in range(MOST_OWN):
            if not len(waiting):
                break
            origins = np.ascontiguousarray(starts[waiting] + passed[waiting, None] * ways[waiting])
            hits = cast(origins, np.ascontiguousarray(ways[waiting]))
            reached = passed[waiting] + hits.distances_m
            passing = np.isin(hits.instance_ids, links)
            ranges[waiting[~passing]] = reached[~passing]
            passed[waiting[passing]] = reached[passing] + PASSED_M
            waiting = waiting[passing]
        ranges[ranges > spec.range] = np.inf
        return LaserScan(
            pose=pose,
            angle_min_rad=-0.5 * span,
            angle_increment_rad=increment,
            range_min_m=spec.near,
            range_max_m=spec.range,
            ranges_m=ranges,
            sim_time_ns=sim_time_ns,
        )

    def inertial(
        self,
        sensor: str,
        bodies: Mapping[str, JointedBody],
        gravity: tuple[float, float, float],
        sim_time_ns: int,
    ) -> InertialMeasurement:
        """Return what an inertial sensor measures: the mean of the last step."""
        spec = self.named("imu", sensor)
        linear, angular = self._velocity(spec.name, bodies)
        change = linear - self._before.get(spec.name, linear)
        pose = self.pose(spec.name, bodies)
        turn = pose.matrix()[:3, :3]
        felt = turn.T @ (change * STEPS_PER_SECOND - np.asarray(gravity))
        wx, wy, wz = (turn.T @ angular).tolist()
        ax, ay, az = felt.tolist()
        return InertialMeasurement(
            orientation_xyzw=pose.orientation_xyzw,
            angular_rad_s=(wx, wy, wz),
            acceleration_m_s2=(ax, ay, az),
            sim_time_ns=sim_time_ns,
        )

    def _velocity(self, sensor: str, bodies: Mapping[str, JointedBody]) -> tuple[Doubles, Doubles]:
        """Return the velocity of a sensor [m/s] and its link's angular one, world axes."""
        _, link, pose = self._sensors[sensor]
        linear, angular = bodies[link].twist()
        arm = bodies[link].world_from_body()[:3, :3] @ np.asarray(pose.position_m)
        return linear + cross(angular, arm), angular
