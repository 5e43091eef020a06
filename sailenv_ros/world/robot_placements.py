"""A robot's description → the placements of its links, which stand in the world like objects."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.scene.spec import JointSpec, ObjectSpec
from sailenv_ros.scene.spec_robots import RobotSpec
from sailenv_ros.types.labels import CategoryTable
from sailenv_ros.types.robots import Mount, RobotLink, RobotModel
from sailenv_ros.world.kinematics import composed
from sailenv_ros.world.placement import JointPlacement, Placement
from sailenv_ros.world.robot_kinematics import joint_links
from sailenv_ros.world.robot_wheels import is_wheel

__all__ = ["RobotPlacement", "link_name", "link_placements"]

MAX_NAME = 63
CATEGORY = "robot"


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class RobotPlacement:
    """A robot to put into the world.

    Attributes
    ----------
    spec : RobotSpec
        What a scene file says of it.
    model : RobotModel
    """

    spec: RobotSpec
    model: RobotModel

    @property
    def mount(self) -> Mount:
        """How its first link is held."""
        return self.spec.mount or self.model.mount


def link_name(robot: str, link: str) -> str:
    """Return the name of the object that is a link of a robot."""
    return f"{robot} {link}"


def link_placements(robot: RobotPlacement, categories: CategoryTable) -> Iterator[Placement]:
    """Yield the placements of a robot's links, parents before what they carry.

    Raises
    ------
    UnknownName
        If the description names a joint, or a sensor's link, that is not there.
    InvalidRequest
        If a name would be too long, or a joint begins beyond its limits.
    """
    spec, model = robot.spec, robot.model
    named = joint_links(model)
    starts = dict(model.start)
    for told in spec.joints:
        if told.name not in named:
            raise UnknownName(f"joint of robot {spec.name!r}", told.name, named)
        if told.position is not None:
            starts[told.name] = told.position
    for link in model.links:
        yield _placement(robot, link, starts.get(link.joint.name), categories)


def _placement(
    robot: RobotPlacement, link: RobotLink, start: float | None, categories: CategoryTable
) -> Placement:
    spec, joint = robot.spec, link.joint
    name = link_name(spec.name, link.name)
    if len(name) > MAX_NAME:
        what = f"name of link {link.name!r} of robot {spec.name!r}"
        raise InvalidRequest(what, name, f"at most {MAX_NAME} characters")
    pose = joint.parent_from_rest
    if not link.parent:
        pose = composed(spec.pose, pose)
        made = JointSpec(type="fixed" if robot.mount == "fixed" else "free")
        if spec.parent:
            made = JointSpec(type=made.type, parent=spec.parent)
    elif joint.type == "fixed":
        made = JointSpec(type="fixed", parent=link_name(spec.name, link.parent))
    else:
        made = JointSpec(
            type=joint.type,
            parent=link_name(spec.name, link.parent),
            axis=joint.axis,
            origin=joint.origin_m,
            limits=_limits(joint.limits),
            damping=joint.damping,
            friction=joint.friction,
            effort=max(joint.effort, 1e-6),
            position=None if start is None else _within(start, joint.limits, name),
        )
    rolls = robot.mount not in ("fixed", "free") and is_wheel(robot.model, link, spec.wheels)
    entry = ObjectSpec(
        name=name,
        asset=link.asset.name,
        position=pose.position_m,
        orientation=pose.orientation_xyzw,
        joint=made,
        # Wheels are rolled, and do not slip: what drives the robot acts upon its first link.
        friction=0.0 if rolls else link.friction,
    )
    return Placement(
        name=name,
        asset=link.asset,
        category_id=categories.named(CATEGORY).id,
        pose=pose,
        friction=entry.friction,
        spinning_friction=link.spinning_friction,
        joint=JointPlacement(spec=made, parent=made.parent or "", parent_from_rest=pose),
        entry=entry,
        robot=spec.name,
        collides_with_itself=spec.self_collision,
    )


def _limits(limits: tuple[float, float] | None) -> tuple[float, float] | None:
    """Return limits as scene files have them; what cannot move keeps a hair's breadth."""
    if limits is None:
        return None
    low, high = limits
    return (low, high) if low < high else (low - 1e-9, high + 1e-9)


def _within(position: float, limits: tuple[float, float] | None, name: str) -> float:
    if limits is not None and not limits[0] <= position <= limits[1]:
        accepted = f"from {limits[0]:g} to {limits[1]:g}"
        raise InvalidRequest(f"position of {name!r}", position, accepted)
    return position
