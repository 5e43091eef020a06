"""Links and joints as a robot's file has them, before they are checked and joined.

Data between the readers of file formats and `assembling`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.meshes import RawMesh
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.robots import RobotJoint

__all__ = ["Kind", "RawGeometry", "RawJoint", "RawLink"]

Kind = Literal["box", "sphere", "cylinder", "capsule", "ellipsoid", "mesh"]


@dataclass(frozen=True, eq=False, kw_only=True)
class RawGeometry:
    """One shape of a link.

    Attributes
    ----------
    kind : str
    size : tuple of float
        Of a box: its edges; of a ball: its radius; of cylinder and capsule: radius and length along
        z; of an ellipsoid: its half axes [m].
    pose : Pose
        In the link's frame.
    file : Path or None
        Of a mesh.
    mesh : RawMesh or None
        Of a mesh that is read already.
    scale : (3,) tuple of float
        Of a mesh.
    colour : (4,) tuple of float or None
        Linear red, green, blue, and alpha; None where the file says nothing.
    roughness : float
    """

    kind: Kind
    size: tuple[float, ...] = ()
    pose: Pose = field(default_factory=Pose)
    file: Path | None = None
    mesh: RawMesh | None = None
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)
    colour: tuple[float, float, float, float] | None = None
    roughness: float = 0.5


@dataclass(frozen=True, eq=False, kw_only=True)
class RawLink:
    """One link.

    Attributes
    ----------
    name : str
    drawn, collides : list of RawGeometry
    mass_kg : float
    centre_m : (3,) tuple of float
    tensor_kg_m2 : (3, 3) float64
        About the centre of mass, in the link's axes.
    friction, spinning_friction : float or None
        Of its surface; None where the file says nothing.
    place : str
        Where the file has it, as ``file:line:column``, for errors; empty if that is not known.
    """

    name: str
    drawn: list[RawGeometry] = field(default_factory=list)
    collides: list[RawGeometry] = field(default_factory=list)
    mass_kg: float = 0.0
    centre_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    tensor_kg_m2: NDArray[np.float64] = field(default_factory=lambda: np.zeros((3, 3)))
    friction: float | None = None
    spinning_friction: float | None = None
    place: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class RawJoint:
    """One joint, with the names of what it joins, and its place as that of a `RawLink`."""

    parent: str
    child: str
    joint: RobotJoint
    place: str = ""
