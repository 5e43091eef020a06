"""One object or robot of a scene as ROS's `simulation_interfaces` know it: an entity."""

from __future__ import annotations

from dataclasses import dataclass

from sailenv_ros.types.geometry import Pose

__all__ = ["AssetOutline", "Entity", "NamedPose"]

Vector3 = tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Entity:
    """One object at one instant, parts of its model with it; or a robot, with all its links.

    Attributes
    ----------
    id : int
        Instance id; of a robot that of its first link, below 0.
    name : str
        Unique in its scene.
    asset : str
        Catalogue name of what it is; of a robot, its name in its file.
    category : str
        The category's name.
    static : bool
        True if physics never moves it.
    moving : bool
        True if a behaviour moves it.
    added : bool
        True if it was spawned since the scene began.
    pose : Pose
        Of its own frame in the world.
    linear_velocity : (3,) tuple of float
        Of that frame's origin, world axes [m/s].
    angular_velocity : (3,) tuple of float
        World axes [rad/s].
    linear_acceleration, angular_acceleration : (3,) tuple of float
        Of the same in the last step, world axes [m/s²], [rad/s²].
    sim_time_ns : int
        The instant [ns].
    """

    id: int
    name: str
    asset: str
    category: str
    static: bool
    moving: bool
    added: bool
    pose: Pose
    linear_velocity: Vector3
    angular_velocity: Vector3
    linear_acceleration: Vector3
    angular_acceleration: Vector3
    sim_time_ns: int


@dataclass(frozen=True, slots=True, kw_only=True)
class NamedPose:
    """A place in a scene that has a name.

    Attributes
    ----------
    name : str
        Unique among them.
    description : str
    tags : tuple of str
    pose : Pose
    """

    name: str
    description: str
    tags: tuple[str, ...]
    pose: Pose


@dataclass(frozen=True, slots=True, kw_only=True)
class AssetOutline:
    """How much room an asset takes up.

    Attributes
    ----------
    name, display_name, category : str
    box_m : ((3,), (3,)) tuples of float
        Lowest and highest corner of the box around its collision shapes, or around what is drawn
        where it has none, in its own frame [m].
    """

    name: str
    display_name: str
    category: str
    box_m: tuple[Vector3, Vector3]
