"""Contents of a scene as every export format needs them: bodies, their pieces, lights, cameras.

Comes from `gathering`, goes to one writer a file. Meshes, materials and textures are shared: the
same object is written once. Nothing here knows a file format or an engine.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.scene_export.light_map import ExportedLight
from sailenv_ros.scene_export.motion import ExportedMotion
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.labels import Instance
from sailenv_ros.types.lights import Environment, Light
from sailenv_ros.types.model import ModelPart
from sailenv_ros.types.shapes import CollisionShape

__all__ = [
    "BodyJoint",
    "ExportedBody",
    "ExportedCamera",
    "ExportedPiece",
    "ExportedScene",
    "Vector3",
    "Written",
]

Vector3: TypeAlias = tuple[float, float, float]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class ExportedPiece:
    """Something with an instance id of its own: a body without its labelled parts, or one of these.

    Attributes
    ----------
    instance : Instance
    parts : tuple of ModelPart
        In the body frame, before the body's scale; materials have the light of lamps as emission.
    deforms : bool
        True for people, whose vertices move.
    light_places : tuple of (V, 2) float32
        Where the vertices of each part are in the scene's light map; none without one.
    """

    instance: Instance
    parts: tuple[ModelPart, ...]
    deforms: bool = False
    light_places: tuple[NDArray[np.float32], ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class BodyJoint:
    """Joint on which a body moves.

    Attributes
    ----------
    type : {'hinge', 'slide', 'fixed'}
    parent : str
        Name of the body that carries it; empty for the world.
    parent_from_rest : Pose
        Where the body is, in the parent's frame, while the position is 0.
    axis : (3,) tuple of float
        Unit vector in the body's frame.
    origin_m : (3,) tuple of float
        A point of the axis in the body's frame [m].
    limits : (2,) tuple of float or None
        Least and greatest position [rad] or [m]; None where there are none.
    position : float
        Now [rad] or [m].
    friction, damping, effort : float
        [N m] or [N], [N m s/rad] or [N s/m], [N m] or [N].
    acts : bool
        True if it shuts or clicks by itself.
    """

    type: Literal["hinge", "slide", "fixed"]
    parent: str
    parent_from_rest: Pose
    axis: Vector3
    origin_m: Vector3
    limits: tuple[float, float] | None
    position: float
    friction: float
    damping: float
    effort: float
    acts: bool = False


@dataclass(frozen=True, eq=False, kw_only=True)
class ExportedBody:
    """One body of physics.

    Attributes
    ----------
    name : str
        Unique in its scene.
    asset : str
    pieces : tuple of ExportedPiece
        The body's own first.
    pose : Pose
        Of the body frame in the world, now.
    scale : (3,) tuple of float
        Applied to meshes before the pose.
    static : bool
        True if physics never moves it.
    joint : BodyJoint or None
    mass_kg : float
        0 for what is static [kg].
    centre_m : (3,) tuple of float
        Centre of mass in the body's frame, scale included [m].
    inertia_kg_m2 : (3,) tuple of float
        About that centre and the body's axes.
    shapes : tuple of CollisionShape
        In the body's frame, scale included.
    friction, restitution : float
    gravity : bool
        False if gravity does not pull it.
    is_outside : bool
        True for what lies outside a room: it takes no light and gives none.
    """

    name: str
    asset: str
    pieces: tuple[ExportedPiece, ...]
    pose: Pose
    scale: Vector3 = (1.0, 1.0, 1.0)
    static: bool = True
    joint: BodyJoint | None = None
    mass_kg: float = 0.0
    centre_m: Vector3 = (0.0, 0.0, 0.0)
    inertia_kg_m2: Vector3 = (1.0, 1.0, 1.0)
    shapes: tuple[CollisionShape, ...] = ()
    friction: float = 0.5
    restitution: float = 0.0
    gravity: bool = True
    is_outside: bool = False

    @property
    def instance(self) -> Instance:
        """Labels of the body's own piece."""
        return self.pieces[0].instance


@dataclass(frozen=True, slots=True, kw_only=True)
class ExportedCamera:
    """An agent's camera; its pose is that of the camera's body, x along the optical axis."""

    name: str
    intrinsics: CameraIntrinsics
    pose: Pose


@dataclass(frozen=True, eq=False, kw_only=True)
class ExportedScene:
    """A scene at one instant.

    Attributes
    ----------
    name : str
    bodies : tuple of ExportedBody
        In the order of their ids.
    lights : tuple of Light
    environment : Environment or None
        None for a piece alone.
    cameras : tuple of ExportedCamera
    gravity : (3,) tuple of float
        World frame [m/s²].
    motion : ExportedMotion or None
        How it moves from there; None for the instant alone.
    light_map : ExportedLight or None
        Its baked light, instead of lights; None leaves light to these.
    """

    name: str
    bodies: tuple[ExportedBody, ...]
    lights: tuple[Light, ...] = ()
    environment: Environment | None = None
    cameras: tuple[ExportedCamera, ...] = ()
    gravity: Vector3 = (0.0, 0.0, -9.81)
    motion: ExportedMotion | None = None
    light_map: ExportedLight | None = None

    @cached_property
    def parts(self) -> tuple[ModelPart, ...]:
        """Everything that is drawn, each mesh with each of its materials once."""
        pieces = (piece for body in self.bodies for piece in body.pieces)
        drawn = {(id(p.mesh), id(p.material)): p for piece in pieces for p in piece.parts}
        return tuple(drawn.values())

    @cached_property
    def by_name(self) -> dict[str, ExportedBody]:
        """Bodies by their names."""
        return {body.name: body for body in self.bodies}


@dataclass(frozen=True, eq=False, kw_only=True)
class Written:
    """Content of an export, not on disk yet.

    Attributes
    ----------
    data : bytes
        Of the file itself.
    beside : mapping of str to bytes
        Files by their names in the folder beside it.
    losses : tuple of str
        What the format cannot hold, in a sentence each.
    """

    data: bytes
    beside: dict[str, bytes] = field(default_factory=dict)
    losses: tuple[str, ...] = ()
