"""An object to put into the world: what `World.spawn` takes and a `Body` is made of."""

from __future__ import annotations

from dataclasses import dataclass

from sailenv_ros.behaviours import RunningBehaviour
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.scene.spec import JointSpec, ObjectSpec
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.model import Asset, TriangleShape
from sailenv_ros.types.outside import Outside

__all__ = ["JointPlacement", "Placement"]

Vector3 = tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class JointPlacement:
    """Joint by which an object is attached.

    Attributes
    ----------
    spec : JointSpec
    parent : str
        Name of the object that carries it; empty for the world.
    parent_from_rest : Pose
        Where it is, in the parent's frame, while the joint's position is 0.
    """

    spec: JointSpec
    parent: str
    parent_from_rest: Pose


@dataclass(frozen=True, slots=True, kw_only=True)
class Placement:
    """An object to put into the world.

    Attributes
    ----------
    name : str
        Unique in its scene.
    asset : Asset
    category_id : int
    pose : Pose
        Of the body frame.
    scale : (3,) tuple of float
        Each above 0.
    static : bool
        True if physics never moves it.
    mass_kg : float or None
        None takes the asset's mass times the scale's volume [kg].
    gravity : bool
        False if gravity does not pull it.
    friction, restitution : float
    linear_velocity : (3,) tuple of float
        At the start, world frame [m/s].
    angular_velocity : (3,) tuple of float
        At the start, world frame [rad/s].
    behaviours : tuple of RunningBehaviour
    materials : tuple of str
        Names of the asset's own materials.
    joint : JointPlacement or None
        What it moves on; `pose` is only where it begins then.
    entry : ObjectSpec or None
        What a scene file says of it; None for a part of a room.
    outside : Outside or None
        Of what lies outside a room: seen as the sky is, and no part of its light.
    robot : str
        Name of the robot whose link it is; empty if it is none.
    collides_with_itself : bool
        True if what hangs together with it on joints may collide.
    spinning_friction : float
        Torque against spinning over the force that presses [m]; 0 takes that of all objects.
    """

    name: str
    asset: Asset
    category_id: int
    pose: Pose
    scale: Vector3 = (1.0, 1.0, 1.0)
    static: bool = False
    mass_kg: float | None = None
    gravity: bool = True
    friction: float = 0.5
    restitution: float = 0.0
    linear_velocity: Vector3 = (0.0, 0.0, 0.0)
    angular_velocity: Vector3 = (0.0, 0.0, 0.0)
    behaviours: tuple[RunningBehaviour, ...] = ()
    materials: tuple[str, ...] = ()
    joint: JointPlacement | None = None
    entry: ObjectSpec | None = None
    outside: Outside | None = None
    robot: str = ""
    collides_with_itself: bool = False
    spinning_friction: float = 0.0

    def __post_init__(self) -> None:
        hollow = any(isinstance(shape, TriangleShape) for shape in self.asset.collision)
        if hollow and not self.static:
            raise InvalidRequest(
                f"static of {self.name!r}", False, f"true: {self.asset.name!r} is hollow geometry"
            )
        if self.behaviours and self.static:
            raise InvalidRequest(
                f"static of {self.name!r}", True, "false for an object that has behaviours"
            )
