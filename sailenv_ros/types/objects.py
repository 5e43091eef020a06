"""One object of a scene as it is at an instant: what it is, where it is, how it moves.

Made by `world/`, answers requests of clients. Knows no engine and no message.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from sailenv_ros.types.geometry import Pose

__all__ = ["ObjectState"]

Vector3 = tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class ObjectState:
    """One object at one instant; vectors are in the world frame.

    Attributes
    ----------
    id : int
        Instance id: the value of its pixels.
    name : str
        Unique in its scene.
    asset : str
        Catalogue name of what it is.
    category_id : int
    category : str
        The category's name.
    pose : Pose
        Of the asset's origin.
    scale : (3,) tuple of float
        Along the asset's axes.
    size_m : (3,) tuple of float
        Of the box around it in its own axes, scale included [m].
    bottom_m : float
        Lowest z of that box [m]: below 0 for what does not stand on its origin.
    static : bool
        True if physics never moves it.
    mass_kg : float
        0 for what is static [kg].
    linear_velocity : (3,) tuple of float
        Of the centre of mass [m/s].
    angular_velocity : (3,) tuple of float
        [rad/s]
    behaviours : tuple of mapping
        What moves it of itself, each with its ``type`` and all its parameters, as `spawn_object`
        takes them.
    sim_time_ns : int
        The instant [ns].
    """

    id: int
    name: str
    asset: str
    category_id: int
    category: str
    pose: Pose
    scale: Vector3
    size_m: Vector3
    bottom_m: float = 0.0
    static: bool
    mass_kg: float
    linear_velocity: Vector3
    angular_velocity: Vector3
    behaviours: tuple[Mapping[str, Any], ...]
    sim_time_ns: int
