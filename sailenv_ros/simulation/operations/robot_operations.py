"""Operations on robots: articulated machines of URDF and MJCF files."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from numpy.typing import ArrayLike

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.simulation.operations import argument_checks as check
from sailenv_ros.simulation.operations.operation import Caller, operation
from sailenv_ros.simulation.operations.targets import HasEditor, HasWorld, Senses
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.robot_sensors import InertialMeasurement, LaserScan
from sailenv_ros.types.robots import DRIVE_MODES, DriveMode, RobotState
from sailenv_ros.types.validation import Bounds, is_finite_number, vector

__all__ = ["RobotOperations"]


def _numbers(what: str, value: Any) -> dict[str, float]:
    if not isinstance(value, Mapping) or not all(
        isinstance(name, str) and is_finite_number(number) for name, number in value.items()
    ):
        raise InvalidRequest(what, value, "a mapping of names of joints to finite numbers")
    return {name: float(number) for name, number in value.items()}


def _mode(what: str, value: Any) -> DriveMode:
    if value not in DRIVE_MODES:
        raise InvalidRequest(what, value, f"one of: {', '.join(DRIVE_MODES)}")
    return value  # type: ignore[no-any-return]  # one of these texts


def _settings(what: str, value: Any) -> Mapping[str, Any]:
    if not isinstance(value, Mapping) or not all(isinstance(key, str) for key in value):
        raise InvalidRequest(what, value, "a mapping with keys of a robot in a scene file")
    return value


_EFFORT = check.optional(Bounds(above=0.0, most=1e6).number)
_SPEED = check.optional(Bounds(above=0.0, most=100.0).number)
_GAIN = check.optional(Bounds(above=0.0, most=240.0, unit="1/s").number)
_RATE = Bounds(least=-100.0, most=100.0).number


class RobotOperations(Caller):
    """Robots. One is named by its name; the empty name means the first of the scene.

    Positions of joints are in radians for hinges and in metres for slides.
    """

    @operation(
        deadline_s=120.0,
        file=check.text,
        position=check.optional(vector),
        rotation=check.optional(vector),
        pose=check.optional(check.pose),
        name=check.text,
        mount=check.text,
        settings=check.optional(_settings),
    )
    @staticmethod
    def spawn_robot(
        core: HasEditor,
        file: str,
        position: ArrayLike | None = None,
        rotation: ArrayLike | None = None,
        *,
        pose: Pose | None = None,
        name: str = "",
        mount: str = "",
        settings: Mapping[str, Any] | None = None,
    ) -> str:
        """Add a robot to the scene; return its name.

        Parameters
        ----------
        file : str
            URDF, as xacro writes it, or MJCF: a path of the simulator's computer, or
            ``PACKAGE:path``, a file of an installed Python package.
        position : (3,) array-like or None
            Of its first link, world frame [m]; None is the world's origin.
        rotation : (3,) array-like or None
            Roll, pitch, yaw about fixed axes [deg].
        pose : Pose or None
            Instead of position and rotation, not beside them.
        name : str
            Unique in the scene; empty makes one of the file's.
        mount : str
            ``fixed``, ``free``, ``differential``, ``mecanum`` or ``ackermann``; empty takes
            ``fixed``, and for MJCF what the file says.
        settings : mapping or None
            Further keys of a robot in a scene file: ``joints``, ``wheels``, ``sensors``,
            ``self_collision``, ``parent``.

        Raises
        ------
        UnknownName, NameTaken, InvalidEntry, AssetError
            If it cannot be read or placed; the scene is as it was then.

        >>> name = simulation.spawn_robot("panda.urdf", (0, 0, 0.8))  # doctest: +SKIP
        """
        entry = {**(settings or {}), "file": file}
        if name:
            entry["name"] = name
        if mount:
            entry["mount"] = mount
        return core.editor.spawn_robot(entry, check.pose_of(position, rotation, pose))

    @operation(robot=check.text)
    @staticmethod
    def despawn_robot(core: HasWorld, robot: str = "") -> None:
        """Remove a robot with all its links; their ids are not used again."""
        core.world.despawn_robot(robot)
        core.announce()

    @operation()
    @staticmethod
    def get_robots(core: HasWorld) -> tuple[str, ...]:
        """Return the names of the robots of the scene, in the order they came."""
        return tuple(robot.name for robot in core.world.robots)

    @operation(robot=check.text)
    @staticmethod
    def get_robot(core: HasWorld, robot: str = "") -> RobotState:
        """Return what a robot is doing now: links, joints, motors, pose and velocity."""
        return core.world.robot_state(robot)

    @operation(robot=check.text)
    @staticmethod
    def robot_description(core: HasWorld, robot: str = "") -> str:
        """Return the text of a robot's URDF file, with full paths of meshes; empty for MJCF."""
        return core.world.robots[robot].model.description

    @operation(
        targets=_numbers, mode=_mode, robot=check.text, gain=_GAIN, effort=_EFFORT, speed=_SPEED
    )
    @staticmethod
    def drive_joints(
        core: HasWorld,
        targets: Mapping[str, float],
        mode: DriveMode = "position",
        *,
        robot: str = "",
        gain: float | None = None,
        effort: float | None = None,
        speed: float | None = None,
    ) -> None:
        """Let motors of a robot follow targets from now on, all at once.

        Parameters
        ----------
        targets : mapping of str to float
            By names of joints: positions [rad] or [m], speeds [rad/s] or [m/s], or torques [N m]
            or forces [N].
        mode : {'position', 'velocity', 'effort', 'off'}
            ``off`` leaves joints to their friction.
        robot : str
        gain : float or None
            Of positions: speed for each unit of the error, 0 to 240 [1/s].
        effort, speed : float or None
            The largest; None takes the file's, which it cannot exceed.

        Raises
        ------
        UnknownName, InvalidRequest
            If there is no such joint, it follows another, or a target is beyond its limits; no
            motor is told anything then.
        """
        core.world.robots[robot].drive(targets, mode, gain=gain, effort=effort, speed=speed)

    @operation(positions=_numbers, robot=check.text)
    @staticmethod
    def put_joints(core: HasWorld, positions: Mapping[str, float], *, robot: str = "") -> None:
        """Put joints of a robot somewhere at once; their motors hold them there.

        Raises
        ------
        UnknownName, InvalidRequest
            As of `drive_joints`.
        """
        core.world.robots[robot].put_joints(positions)
        core.world.robot_moved()

    @operation(
        forward_m_s=_RATE,
        left_m_s=_RATE,
        turn_rad_s=_RATE,
        seconds=Bounds(above=0.0, most=1e6, unit="s").number,
        robot=check.text,
    )
    @staticmethod
    def drive_robot(
        core: HasWorld,
        forward_m_s: float = 0.0,
        turn_rad_s: float = 0.0,
        left_m_s: float = 0.0,
        *,
        seconds: float = 0.5,
        robot: str = "",
    ) -> None:
        """Let the wheels of a robot drive it for some simulated time.

        Parameters
        ----------
        forward_m_s, left_m_s : float
            In its own axes; left is possible on mecanum wheels alone [m/s].
        turn_rad_s : float
            To the left [rad/s].
        seconds : float
            Until it stops, 0 to 1e6 [s].
        robot : str

        Raises
        ------
        UnknownName, InvalidRequest
            If there is no such robot, or it has no wheels.
        """
        world = core.world
        until_s = world.sim_time_ns * 1e-9 + seconds
        world.robots[robot].command((forward_m_s, left_m_s, turn_rad_s), until_s)

    @operation(link=check.text, joints=check.optional(_numbers), robot=check.text)
    @staticmethod
    def link_pose(
        core: HasWorld,
        link: str,
        joints: Mapping[str, float] | None = None,
        *,
        robot: str = "",
    ) -> Pose:
        """Return the pose of a link in the world: forward kinematics.

        Parameters
        ----------
        link : str
            As the file calls it, also one that is only a frame.
        joints : mapping of str to float or None
            Positions of joints that are elsewhere than now; nothing is moved.
        robot : str
        """
        return core.world.robots[robot].world_from_frame(link, joints)

    @operation(link=check.text, pose=check.pose, robot=check.text)
    @staticmethod
    def reach_pose(
        core: HasWorld, link: str, pose: Pose, *, robot: str = ""
    ) -> Mapping[str, float]:
        """Return positions of all joints that bring a link to a pose: inverse kinematics.

        Parameters
        ----------
        link : str
            As the file calls it, also one that is only a frame.
        pose : Pose
            In the world.
        robot : str

        Returns
        -------
        positions : mapping of str to float
            Those now, where a joint does not carry the link. Nothing is moved.

        Raises
        ------
        UnknownName, InvalidRequest
            If there is no such link, or no positions within the limits reach the pose.
        """
        return core.world.robots[robot].reaching(link, pose)

    @operation(sensor=check.text, robot=check.text)
    @staticmethod
    def get_scan(core: Senses, sensor: str = "", *, robot: str = "") -> LaserScan:
        """Return what a laser scanner of a robot measures now.

        It meets what the views show, the links of its own robot left out.
        """
        return core.world.robot_scan(robot, sensor, core.space.cast_rays)

    @operation(sensor=check.text, robot=check.text)
    @staticmethod
    def get_inertial(core: HasWorld, sensor: str = "", *, robot: str = "") -> InertialMeasurement:
        """Return what an inertial sensor of a robot measures now: the mean of the last step."""
        return core.world.robot_inertial(robot, sensor)
