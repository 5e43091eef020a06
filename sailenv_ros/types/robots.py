"""Robots: links on joints as a file describes them, and their state at an instant.

`RobotModel` comes from `assets/robots` and goes to `world/`; `RobotState` answers requests of
clients. Knows no file format, no engine and no message.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.labels import Instance
from sailenv_ros.types.model import Asset

__all__ = [
    "DRIVE_MODES",
    "LINK_ASSETS",
    "MOUNTS",
    "DriveMode",
    "Mimic",
    "Mount",
    "RobotFrame",
    "RobotJoint",
    "RobotJointState",
    "RobotLink",
    "RobotModel",
    "RobotState",
    "first_links",
    "link_of_asset",
]

Mount: TypeAlias = Literal["fixed", "free", "differential", "mecanum", "ackermann"]

MOUNTS: tuple[Mount, ...] = ("fixed", "free", "differential", "mecanum", "ackermann")
"""How the first link is held: not at all, by the world, or by wheels that drive it."""

DriveMode: TypeAlias = Literal["position", "velocity", "effort", "off"]

DRIVE_MODES: tuple[DriveMode, ...] = ("position", "velocity", "effort", "off")
"""Quantities that a joint's motor follows; ``off`` leaves it to its friction."""


LINK_ASSETS = "robot:"
"""Begin of the names of links' assets: ``robot:FILE:DIGEST#LINK``."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Mimic:
    """A joint that goes with another: position = multiplier · that of `joint` + offset."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotJoint:
    """A joint between a link and its parent.

    Attributes
    ----------
    name : str
        Of the file; empty for the first link.
    type : {'hinge', 'slide', 'fixed'}
    parent_from_rest : Pose
        Frame of the link in that of its parent while the position is 0.
    axis : (3,) tuple of float
        In the link's frame.
    origin_m : (3,) tuple of float
        A point of the axis, in the link's frame [m].
    limits : (2,) tuple of float or None
        [rad] or [m].
    effort : float
        Largest torque [N m] or force [N].
    speed : float
        Largest speed [rad/s] or [m/s].
    damping, friction : float
        [N m s/rad] and [N m], or [N s/m] and [N].
    mimic : Mimic or None
    """

    name: str = ""
    type: Literal["hinge", "slide", "fixed"] = "fixed"
    parent_from_rest: Pose = field(default_factory=Pose)
    axis: tuple[float, float, float] = (1.0, 0.0, 0.0)
    origin_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    limits: tuple[float, float] | None = None
    effort: float = 1000.0
    speed: float = 100.0
    damping: float = 0.0
    friction: float = 0.0
    mimic: Mimic | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotLink:
    """A rigid body of a robot.

    Attributes
    ----------
    name : str
        Of the file.
    parent : str
        Name of the link that carries it; empty for the first.
    joint : RobotJoint
    asset : Asset
        Geometry, mass and inertia in the link's frame.
    friction, spinning_friction : float
        Coefficient of its surface; torque against spinning over the force that presses [m].
    """

    name: str
    parent: str
    joint: RobotJoint
    asset: Asset
    friction: float = 0.5
    spinning_friction: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotFrame:
    """A link without geometry and mass: a place on another link."""

    name: str
    link: str
    pose: Pose


@dataclass(frozen=True, eq=False, kw_only=True)
class RobotModel:
    """A robot as its file describes it.

    Attributes
    ----------
    name : str
        Of the file.
    links : tuple of RobotLink
        Parents before what they carry.
    frames : tuple of RobotFrame
    description : str
        The file's own text, with full paths of meshes; empty for MJCF.
    mount : str
        How its first link is held where nothing else is said.
    start : mapping of str to float
        Positions of joints at the start that are not 0, by their names.
    """

    name: str
    links: tuple[RobotLink, ...]
    frames: tuple[RobotFrame, ...] = ()
    description: str = ""
    mount: Mount = "fixed"
    start: Mapping[str, float] = field(default_factory=dict)

    @property
    def moving(self) -> tuple[RobotLink, ...]:
        """The links on joints that move."""
        return tuple(link for link in self.links if link.joint.type != "fixed")


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotJointState:
    """One joint of a robot at one instant; units as of `RobotJoint`.

    Attributes
    ----------
    name, link : str
        Of the file.
    type : {'hinge', 'slide'}
    position, velocity : float
    effort : float
        What its motor exerted in the last step [N m] or [N].
    mode : {'position', 'velocity', 'effort', 'off'}
    target : float
        Of the motor, in the unit of its mode.
    low, high : float
        Limits; infinite where there are none.
    """

    name: str
    link: str
    type: Literal["hinge", "slide"]
    position: float
    velocity: float
    effort: float
    mode: DriveMode
    target: float
    low: float
    high: float


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotState:
    """A robot at one instant.

    Attributes
    ----------
    name : str
    file : str
    mount : {'fixed', 'free', 'differential', 'mecanum', 'ackermann'}
    links : mapping of str to int
        Instance ids of the links by the names in the file.
    joints : tuple of RobotJointState
    pose : Pose
        Of the first link, world frame.
    linear_m_s, angular_rad_s : (3,) tuple of float
        Velocity of the first link's origin, in its own axes.
    command : (3,) tuple of float
        What the wheels are told: forward and left [m/s], turning left [rad/s].
    sim_time_ns : int
    """

    name: str
    file: str
    mount: Mount
    links: Mapping[str, int]
    joints: tuple[RobotJointState, ...]
    pose: Pose
    linear_m_s: tuple[float, float, float]
    angular_rad_s: tuple[float, float, float]
    command: tuple[float, float, float]
    sim_time_ns: int


def link_of_asset(asset: str) -> str:
    """Return which link of its robot an asset is; empty for what is none."""
    return asset.partition("#")[2] if asset.startswith(LINK_ASSETS) else ""


def first_links(instances: Iterable[Instance]) -> dict[str, int]:
    """Return the instance ids of the first links of a scene's robots, by the robots' names."""
    links = {one.id: one for one in instances if link_of_asset(one.asset)}
    return {
        one.name.removesuffix(f" {link_of_asset(one.asset)}"): one.id
        for one in links.values()
        if one.parent not in links
    }
