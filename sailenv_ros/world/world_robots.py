"""Questions about the robots of a world, and what is done to them."""

from __future__ import annotations

from sailenv_ros.errors import InvalidRequest, NameTaken
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.robot_sensors import InertialMeasurement, LaserScan
from sailenv_ros.types.robots import RobotState
from sailenv_ros.world.robot import Robot
from sailenv_ros.world.robot_placements import RobotPlacement, link_name
from sailenv_ros.world.robot_sensing import CastRays
from sailenv_ros.world.world_state import WorldState

__all__ = ["WorldRobots"]


class WorldRobots(WorldState):
    """The part of `World` that knows robots."""

    def spawn_robot(self, placement: RobotPlacement) -> Robot:
        """Put one more robot into the world; see `RobotTable.add` for errors."""
        robot = self.robots.add(placement, self.categories)
        self._changed_step = self._step
        self._changed()
        return robot

    def despawn_robot(self, name: str) -> None:
        """Take a robot out of the world with its links; their ids are not used again."""
        self.robots.remove(name)
        self._changed_step = self._step
        self._changed()

    def frame_pose(self, name: str) -> Pose:
        """Return where an object is, or a frame upon a robot's link, by ``<robot> <frame>``.

        Raises
        ------
        UnknownName, InvalidRequest
            If there is nothing of that name now.
        """
        for robot in self.robots:
            for frame in robot.model.frames:
                if name == link_name(robot.name, frame.name):
                    return robot.world_from_frame(frame.name)
        return self.body(self.find(name)).pose()

    def robot_moved(self) -> None:
        """Take note that something of a robot was put elsewhere."""
        self._changed_step = self._step
        self._snapshot = self._states = None

    def robot_state(self, name: str) -> RobotState:
        """Return what a robot is doing now; the empty name means the first.

        Raises
        ------
        UnknownName
        """
        return self.robots.state(self.robots[name], self.sim_time_ns)

    def robot_scan(self, name: str, sensor: str, cast: CastRays) -> LaserScan:
        """Return what a laser scanner of a robot measures now.

        Raises
        ------
        UnknownName
        """
        robot = self.robots[name]
        own = self.robot_state(name).links.values()
        return robot.sensors.scan(sensor, robot.bodies, list(own), cast, self.sim_time_ns)

    def robot_inertial(self, name: str, sensor: str) -> InertialMeasurement:
        """Return what an inertial sensor of a robot measures now.

        Raises
        ------
        UnknownName
        """
        robot = self.robots[name]
        return robot.sensors.inertial(sensor, robot.bodies, self.gravity, self.sim_time_ns)

    def _require_no_link(self, instance_id: int, what: str) -> None:
        """Refuse a link of a robot; `what` ends "object …" in the error."""
        if instance_id in self._bodies.waiting:
            return
        placement = self._bodies[instance_id].placement
        if placement.robot:
            accepted = f"one that is no link of a robot; {placement.robot!r} goes as a whole"
            raise InvalidRequest(f"object {what}", placement.name, accepted)

    def _require_no_robot(self, name: str) -> None:
        """Refuse an object the name of a robot."""
        if any(robot.name == name for robot in self.robots):
            raise NameTaken("object", name)
