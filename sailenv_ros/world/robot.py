"""A robot in the world: its motors, its wheels, and what clients may know of it.

Its links are objects on joints; a `JointTree` moves them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.postures.limbs import cross
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.robots import DriveMode, RobotJointState, RobotState
from sailenv_ros.types.validation import checked_number
from sailenv_ros.world.bullet import STEPS_PER_SECOND, BulletClient
from sailenv_ros.world.joint_links import JointDrive
from sailenv_ros.world.joint_tree import JointTree
from sailenv_ros.world.jointed_bodies import JointedBody
from sailenv_ros.world.robot_collision import let_pass
from sailenv_ros.world.robot_kinematics import (
    all_positions,
    base_from_frame,
    reaching,
)
from sailenv_ros.world.robot_motors import bounds, first_drive
from sailenv_ros.world.robot_placements import RobotPlacement
from sailenv_ros.world.robot_sensing import RobotSensors
from sailenv_ros.world.robot_wheels import Planar, Wheels

__all__ = ["Robot"]

STEP_S = 1.0 / STEPS_PER_SECOND

STANDS: Planar = (0.0, 0.0, 0.0)

AT_REST = 1e-3
"""Slower, a robot that is told nothing stands [m/s], [rad/s]."""

STEERING = {"gain": 30.0, "effort": 1e3, "speed": 4.0}
"""Motors that steer: as strong as it takes, and not so quick that they shake what is light."""


class Robot:
    """One robot.

    Parameters
    ----------
    client : BulletClient
    placement : RobotPlacement
    bodies : mapping of str to JointedBody
        Its links by their names in the file.

    Raises
    ------
    UnknownName, InvalidRequest
        If its description does not fit.
    """

    def __init__(
        self,
        client: BulletClient,
        placement: RobotPlacement,
        bodies: Mapping[str, JointedBody],
    ) -> None:
        self._client = client
        self.placement = placement
        self.model = placement.model
        self.take_bodies(bodies)
        self._files = {link.joint.name: link.joint for link in self.model.moving}
        self._prepared: JointTree | None = None
        self.wheels: Wheels | None = None
        if placement.mount not in ("fixed", "free"):
            self.wheels = Wheels(placement.mount, self.model, placement.spec.wheels)
        self.sensors = RobotSensors(placement)
        self._command: Planar = STANDS
        self._until_s = -math.inf
        rolled = () if self.wheels is None else self.wheels.joints
        self._drives = {
            name: first_drive(placement.spec, self._files[name], body.joint_state()[0])
            for name, body in self._joints.items()
            if name not in rolled
        }

    def take_bodies(self, bodies: Mapping[str, JointedBody]) -> None:
        """Take the bodies of the links, by the links' names."""
        self.bodies = dict(bodies)
        self._first = bodies[self.model.links[0].name]
        self._joints = {link.joint.name: bodies[link.name] for link in self.model.moving}

    @property
    def name(self) -> str:
        """Its name in the scene."""
        return self.placement.spec.name

    @property
    def tree(self) -> JointTree:
        """Its joints in the engine."""
        assert self._first.tree is not None
        return self._first.tree

    # -- what it is told -------------------------------------------------------------------

    def drive(
        self,
        targets: Mapping[str, float],
        mode: DriveMode,
        *,
        gain: float | None = None,
        effort: float | None = None,
        speed: float | None = None,
    ) -> None:
        """Let motors follow targets from now on, all at once; see `JointDrive`.

        Raises
        ------
        UnknownName, InvalidRequest
            If a joint is not there, follows another or is a wheel's, or a target is beyond its
            limits; nothing is changed then.
        """
        wanted = {}
        for name, target in targets.items():
            now = self._drive_of(name)
            file = self._files[name]
            low, high = bounds(mode, file.limits, file.speed, now.effort)
            what = f"{mode} of joint {name!r}"
            wanted[name] = replace(
                now,
                mode=mode,
                target=checked_number(what, target, low, high) if mode != "off" else 0.0,
                gain=now.gain if gain is None else gain,
                effort=file.effort if effort is None else min(effort, file.effort),
                speed=file.speed if speed is None else min(speed, file.speed),
            )
        self._drives.update(wanted)
        self._apply(wanted)

    def put_joints(self, positions: Mapping[str, float]) -> None:
        """Put joints somewhere at once, and let their motors hold them there.

        Raises
        ------
        UnknownName, InvalidRequest
            As of `drive`.
        """
        self.drive(positions, "position")
        for name, position in self._with_followers(positions).items():
            self.tree.set(self._joints[name].place, position)
        self.tree.wake()

    def put_back(self) -> None:
        """Put it where it began, with its motors as at the start."""
        spec, tree = self.placement.spec, self.tree
        if self.placement.mount != "fixed":
            self._first.put(self._first.placement.pose)
        for name, body in self._joints.items():
            start = body.joint.spec.start
            tree.set(body.place, start)
            if name in self._drives:
                self._drives[name] = first_drive(spec, self._files[name], start)
        self._command, self._until_s = STANDS, -math.inf
        self._apply(self._drives)
        tree.wake()

    def command(self, velocity: Planar, until_s: float) -> None:
        """Let the wheels drive it until a simulated time [s].

        Raises
        ------
        InvalidRequest
            If it has no wheels.
        """
        if self.wheels is None:
            accepted = "one that is mounted on wheels: differential, mecanum or ackermann"
            raise InvalidRequest("robot", self.name, accepted)
        self._command, self._until_s = self.wheels.possible(velocity), until_s
        if any(self._command):
            self.tree.wake()

    def before_step(self, now_s: float, leader: Callable[[str], Pose]) -> None:
        """Do what its wheels and motors have to before a step; `leader` tells where a mover is."""
        if self._prepared is not self.tree:
            self.prepare()
        self.sensors.before_step(self.bodies)
        if self.wheels is not None:
            if now_s >= self._until_s - 1e-9:
                mover = self.placement.spec.wheels.mover
                self._command = self._led(self.wheels, leader(mover)) if mover else STANDS
            self._roll(self.wheels)

    def prepare(self) -> None:
        """Couple joints, let links pass that touch at rest, and tell motors their targets."""
        tree = self._prepared = self.tree
        for name, joint in self._files.items():
            if joint.mimic is not None:
                leader, follower = self._joints[joint.mimic.joint], self._joints[name]
                mimic = joint.mimic
                tree.couple(leader.place, follower.place, mimic.multiplier, mimic.offset)
        if self.placement.spec.self_collision:
            let_pass(self._client, self.model, self.bodies)
        self._apply(self._drives)

    # -- what is read ----------------------------------------------------------------------

    def positions(self) -> dict[str, float]:
        """Return the positions of all joints that move."""
        return {name: body.joint_state()[0] for name, body in self._joints.items()}

    def world_from_frame(self, frame: str, positions: Mapping[str, float] | None = None) -> Pose:
        """Return the pose of a link or a frame, now or with other positions of joints.

        Raises
        ------
        UnknownName
            If there is no such link or joint.
        """
        now = self.positions()
        for name in positions or ():
            if name not in now:
                raise UnknownName(f"joint of robot {self.name!r}", name, now)
        if positions is not None:
            now.update(self._with_followers(positions))
        base = self._first.world_from_body()
        return Pose.from_matrix(base @ base_from_frame(self.model, frame, now))

    def reaching(self, frame: str, world_from_goal: Pose) -> dict[str, float]:
        """Return positions of joints that bring a link or a frame to a pose in the world."""
        base = np.linalg.inv(self._first.world_from_body())
        goal = Pose.from_matrix(base @ world_from_goal.matrix())
        return reaching(self.model, frame, goal, self.positions())

    def first_pose(self) -> Pose:
        """Return where its description puts it: the pose of its first link."""
        return self._first.pose()

    @property
    def drives(self) -> Mapping[str, JointDrive]:
        """Targets of the motors by the joints' names; wheels are not among them."""
        return self._drives

    def state(self, ids: Mapping[str, int], sim_time_ns: int) -> RobotState:
        """Return all that clients may know now; `ids` of its links by their objects' names."""
        turn = self._first.world_from_body()[:3, :3]
        linear, angular = self._first.twist()
        (vx, vy, vz), (wx, wy, wz) = (turn.T @ linear).tolist(), (turn.T @ angular).tolist()
        return RobotState(
            name=self.name,
            file=self.placement.spec.file,
            mount=self.placement.mount,
            links={name: ids[body.placement.name] for name, body in self.bodies.items()},
            joints=tuple(self._joint_state(name) for name in self._joints),
            pose=self._first.pose(),
            linear_m_s=(vx, vy, vz),
            angular_rad_s=(wx, wy, wz),
            command=self._command,
            sim_time_ns=sim_time_ns,
        )

    # -- inside ----------------------------------------------------------------------------

    def _joint_state(self, name: str) -> RobotJointState:
        body, joint = self._joints[name], self._files[name]
        position, velocity = body.joint_state()
        drive = self._drives.get(name)
        low, high = joint.limits or (-math.inf, math.inf)
        assert joint.type != "fixed"
        return RobotJointState(
            name=name,
            link=next(link for link, one in self.bodies.items() if one is body),
            type=joint.type,
            position=position,
            velocity=velocity,
            effort=self.tree.effort(body.place),
            mode="off" if drive is None else drive.mode,
            target=0.0 if drive is None else drive.target,
            low=low,
            high=high,
        )

    def _drive_of(self, name: str) -> JointDrive:
        if name not in self._joints:
            raise UnknownName(f"joint of robot {self.name!r}", name, self._joints)
        mimic = self._files[name].mimic
        if mimic is not None:
            accepted = f"{mimic.joint!r}, which it follows"
            raise InvalidRequest(f"joint of robot {self.name!r}", name, accepted)
        if name not in self._drives:
            raise InvalidRequest(f"joint of robot {self.name!r}", name, "none of its wheels")
        return self._drives[name]

    def _with_followers(self, positions: Mapping[str, float]) -> dict[str, float]:
        whole = all_positions(self.model, positions)
        following = {
            name
            for name, joint in self._files.items()
            if joint.mimic is not None and joint.mimic.joint in positions
        }
        return {name: whole[name] for name in (*positions, *following)}

    def _apply(self, drives: Mapping[str, JointDrive]) -> None:
        for name, drive in drives.items():
            self.tree.follow(self._joints[name].place, drive)

    def _led(self, wheels: Wheels, world_from_leader: Pose) -> Planar:
        """Return what takes it to its mover."""
        here = self._first.world_from_body()
        wanted = wheels.towards(np.linalg.inv(here) @ world_from_leader.matrix())
        if any(wanted):
            self.tree.wake()
        return wanted

    def _roll(self, wheels: Wheels) -> None:
        """Drive the first link as far as traction allows, and turn the wheels as it moves."""
        matrix = self._first.world_from_body()
        linear, angular = self._first.twist()
        heading = math.atan2(matrix[1, 0], matrix[0, 0])
        cos, sin = math.cos(heading), math.sin(heading)
        vx, vy, vz = linear.tolist()
        now = (cos * vx + sin * vy, cos * vy - sin * vx, float(angular[2]))
        forward, left, turn = moving = wheels.step(now, self._command, STEP_S)
        if moving != now:
            spin = np.array([angular[0], angular[1], turn])
            origin = np.array([cos * forward - sin * left, sin * forward + cos * left, vz])
            arm = matrix[:3, :3] @ np.asarray(self._first.placement.asset.centre_of_mass_m)
            centre = origin + cross(spin, arm)
            self._client.resetBaseVelocity(self.tree.bullet_id, centre.tolist(), spin.tolist())
        stands = not any(self._command) and max(map(abs, moving)) < AT_REST
        for name, speed in wheels.speeds(STANDS if stands else moving).items():
            self.tree.roll(self._joints[name].place, speed)
        if any(self._command):
            for name, angle in wheels.angles(moving).items():
                drive = JointDrive(mode="position", target=angle, **STEERING)
                self.tree.follow(self._joints[name].place, drive)
