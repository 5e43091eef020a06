"""The robots of a world by name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from sailenv_ros.errors import NameTaken, UnknownName
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.labels import CategoryTable
from sailenv_ros.types.robots import RobotState
from sailenv_ros.world.body_table import BodyTable
from sailenv_ros.world.bullet import STEPS_PER_SECOND, BulletClient, sim_time_ns
from sailenv_ros.world.engine_settings import subdivide_steps
from sailenv_ros.world.jointed_bodies import JointedBody
from sailenv_ros.world.mover_table import MoverTable
from sailenv_ros.world.robot import Robot
from sailenv_ros.world.robot_placements import RobotPlacement, link_name, link_placements

__all__ = ["RobotTable"]


class RobotTable:
    """All robots of a world, in the order they came.

    Parameters
    ----------
    client : BulletClient
    bodies : BodyTable
        With the links of `robots` in it.
    robots : sequence of RobotPlacement
    movers : MoverTable
        Those that may lead robots.
    """

    def __init__(
        self,
        client: BulletClient,
        bodies: BodyTable,
        robots: Sequence[RobotPlacement],
        movers: MoverTable,
    ) -> None:
        self._movers = movers
        self._client = client
        self._bodies = bodies
        self._robots: dict[str, Robot] = {}
        for placement in robots:
            self._begin(placement)
        self._firsts = frozenset(self._robots)

    def __iter__(self) -> Iterator[Robot]:
        return iter(self._robots.values())

    def __bool__(self) -> bool:
        return bool(self._robots)

    def __getitem__(self, name: str) -> Robot:
        """Find a robot; the empty name means the first.

        Raises
        ------
        UnknownName
        """
        if not name and self._robots:
            return next(iter(self))
        if name not in self._robots:
            raise UnknownName("robot", name, self._robots)
        return self._robots[name]

    @property
    def added(self) -> tuple[str, ...]:
        """Names of the robots that came since the start."""
        return tuple(name for name in self._robots if name not in self._firsts)

    def add(self, placement: RobotPlacement, categories: CategoryTable) -> Robot:
        """Put one more robot into the world, all of its links or none.

        Raises
        ------
        NameTaken, UnknownName, InvalidRequest
            If its name, or that of a link, is taken, or its description does not fit.
        """
        name = placement.spec.name
        if name in self._robots or self._bodies.id_of_name(name):
            raise NameTaken("robot", name)
        added = self._bodies.add_all(tuple(link_placements(placement, categories)))
        try:
            return self._begin(placement)
        except BaseException:
            self._robots.pop(name, None)
            subdivide_steps(self._client, robots=bool(self))
            self._bodies.remove_all(added)
            raise

    def remove(self, name: str) -> None:
        """Take a robot out of the world with its links."""
        robot = self[name]
        own = {id(body) for body in robot.bodies.values()}
        numbers = [number for number, body in self._bodies.items() if id(body) in own]
        self._bodies.remove_all(numbers)
        del self._robots[robot.name]
        subdivide_steps(self._client, robots=bool(self))
        self._firsts -= {robot.name}

    def state(self, robot: Robot, sim_time_ns: int) -> RobotState:
        """Return all that clients may know of a robot."""
        ids = {body.placement.name: number for number, body in self._bodies.items()}
        return robot.state(ids, sim_time_ns)

    def before_step(self, step: int) -> None:
        """Do what wheels and motors have to before a step, which so many came before."""

        def leader(mover: str) -> Pose:
            return self._movers[mover].pose_at(sim_time_ns(step))

        for robot in self._robots.values():
            robot.before_step(step / STEPS_PER_SECOND, leader)

    def put_back(self) -> list[int]:
        """Put robots of the start, which are still there, where they began; return their ids."""
        moved: list[int] = []
        for name in sorted(self._firsts & set(self._robots)):
            robot = self._robots[name]
            robot.put_back()
            own = {id(body) for body in robot.bodies.values()}
            moved += [number for number, body in self._bodies.items() if id(body) in own]
        return moved

    def renew(self) -> None:
        """Take note of links whose bodies were made again."""
        for robot in self._robots.values():
            robot.take_bodies(self._bodies_of(robot.placement))

    def _begin(self, placement: RobotPlacement) -> Robot:
        self._movers[placement.spec.wheels.mover or ""]  # which says if there is none
        robot = Robot(self._client, placement, self._bodies_of(placement))
        self._robots[robot.name] = robot
        subdivide_steps(self._client, robots=True)
        robot.prepare()
        return robot

    def _bodies_of(self, placement: RobotPlacement) -> dict[str, JointedBody]:
        by_name: Mapping[str, JointedBody] = {
            body.placement.name: body for body in self._bodies if isinstance(body, JointedBody)
        }
        return {
            link.name: by_name[link_name(placement.spec.name, link.name)]
            for link in placement.model.links
        }
