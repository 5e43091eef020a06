"""Appearance and collision geometry of objects: meshes, materials, collision shapes, assets.

Travels from `assets/` to `world/` (which reads shapes and mass) and `render/` (which reads
parts). Nothing here knows a file format, PyBullet or OpenGL. Models are compared by identity:
the same object is uploaded to the GPU once.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import AssetError
from sailenv_ros.types.inertia import Inertia
from sailenv_ros.types.joints import Detents, SoftClose
from sailenv_ros.types.mesh import Mesh, joined_vectors
from sailenv_ros.types.rig import Rig
from sailenv_ros.types.shapes import (
    BoxShape,
    CollisionShape,
    ConvexShape,
    CylinderShape,
    SphereShape,
    TriangleShape,
)

__all__ = [
    "Asset",
    "AssetPart",
    "BoxShape",
    "CollisionShape",
    "ConvexShape",
    "CylinderShape",
    "LEAST_CLOTH",
    "Material",
    "Mesh",
    "Model",
    "ModelPart",
    "MovingPart",
    "SphereShape",
    "TriangleShape",
]

Texture: TypeAlias = NDArray[np.uint8]

LEAST_CLOTH = 0.5
"""Roughness from which what is see-through is cloth and mirrors nothing, as light_law.h has it."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Material:
    """A metallic-roughness material (the factors and maps of glTF 2.0).

    Attributes
    ----------
    name : str
    base_colour : (4,) tuple of float
        Linear red, green, blue and alpha, 0 to 1; multiplies the texture.
    metallic, roughness : float
        0 to 1; multiply the texture's blue and green channels.
    emission : (3,) tuple of float
        Linear radiance it emits, always [W/(m² sr)]; the base colour's texture is its pattern.
    glow : (3,) tuple of float
        Linear radiance that it emits besides for each W/sr of the lights that it is lit up by, as
        the shade of a lamp is [1/m²]; see `DrawnInstance.lit_by`.
    base_colour_texture : (H, W, 4) uint8 or None
        sRGB colour and linear alpha; row 0 is the top.
    metallic_roughness_texture : (H, W, 4) uint8 or None
        Green roughness, blue metallic, linear.
    normal_texture : (H, W, 4) uint8 or None
        Tangent-space normals, 128 = 0.
    alpha : {'opaque', 'mask', 'blend'}
        ``mask`` drops pixels whose alpha is below `alpha_cutoff`; ``blend`` is glass.
    alpha_cutoff : float
    double_sided : bool
        True if the back of the triangles is drawn too.
    """

    name: str = ""
    base_colour: tuple[float, float, float, float] = (0.8, 0.8, 0.8, 1.0)
    metallic: float = 0.0
    roughness: float = 0.6
    emission: tuple[float, float, float] = (0.0, 0.0, 0.0)
    glow: tuple[float, float, float] = (0.0, 0.0, 0.0)
    base_colour_texture: Texture | None = None
    metallic_roughness_texture: Texture | None = None
    normal_texture: Texture | None = None
    alpha: Literal["opaque", "mask", "blend"] = "opaque"
    alpha_cutoff: float = 0.5
    double_sided: bool = False

    @property
    def is_veil(self) -> bool:
        """Whether it is see-through cloth."""
        return self.alpha == "blend" and self.roughness >= LEAST_CLOTH


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class ModelPart:
    """One mesh with its material.

    Attributes
    ----------
    mesh : Mesh
    material : Material
    names : tuple of str
        Of the mesh and its node in the file that it came from; empty where they are not known.
    """

    mesh: Mesh
    material: Material
    names: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False, kw_only=True)
class Model:
    """Visible geometry of an object: parts in one body frame."""

    name: str
    parts: tuple[ModelPart, ...]

    def bounds(self) -> NDArray[np.float64]:
        """Return (2, 3) float64 read-only: lowest and highest corner in the body frame [m]."""
        return self._bounds

    @cached_property
    def positions(self) -> NDArray[np.float32]:
        """(V, 3) float32 read-only: vertices of all parts, one part after another [m]."""
        return joined_vectors(part.mesh.positions for part in self.parts)

    @cached_property
    def normals(self) -> NDArray[np.float32]:
        """(V, 3) float32 read-only: unit normals of the same."""
        return joined_vectors(part.mesh.normals for part in self.parts)

    @cached_property
    def middle(self) -> NDArray[np.float64]:
        """(3,) float64 read-only: the middle of the bounds [m]."""
        result: NDArray[np.float64] = self._bounds.mean(axis=0)
        result.flags.writeable = False
        return result

    @cached_property
    def _bounds(self) -> NDArray[np.float64]:
        result = np.zeros((2, 3))
        if self.parts:
            result[0] = np.min([part.mesh.positions.min(axis=0) for part in self.parts], axis=0)
            result[1] = np.max([part.mesh.positions.max(axis=0) for part in self.parts], axis=0)
        result.flags.writeable = False
        return result

    @cached_property
    def is_lamp(self) -> bool:
        """Whether something of it glows by the light of a lamp."""
        return any(any(part.material.glow) for part in self.parts)

    @property
    def triangle_count(self) -> int:
        """Number of triangles of all parts."""
        return sum(len(part.mesh.triangles) for part in self.parts)

    @cached_property
    def is_veil(self) -> bool:
        """Whether all of it is see-through cloth."""
        return bool(self.parts) and all(part.material.is_veil for part in self.parts)

    @property
    def first_vertices(self) -> tuple[int, ...]:
        """Number of each part's first vertex among those of all parts, and how many these are."""
        return (0, *itertools.accumulate(len(part.mesh.positions) for part in self.parts))

    def only(self, meshes: tuple[int, ...]) -> Model:
        """Return a model of some of the parts; the same object for the same ones.

        Parameters
        ----------
        meshes : tuple of int
            Their places in `parts`, ascending.
        """
        if len(meshes) == len(self.parts):
            return self
        made = Model(name=self.name, parts=tuple(self.parts[place] for place in meshes))
        # One step, so that two threads get the same object.
        return self._made.setdefault(meshes, made)

    @cached_property
    def _made(self) -> dict[tuple[int, ...], Model]:
        return {}


@dataclass(frozen=True, slots=True, kw_only=True)
class AssetPart:
    """Some meshes of an asset's model that are labelled as an object of their own.

    Physics knows one body. The part has an instance id, a category and a mask of its own, and the
    body's instance is its parent.

    Attributes
    ----------
    name : str
        Unique in its asset, e.g. ``"left pillow"``.
    category : str
        Name in the category table.
    meshes : tuple of int
        Their places in ``Asset.model.parts``, ascending.
    """

    name: str
    category: str
    meshes: tuple[int, ...]


@dataclass(frozen=True, eq=False, kw_only=True)
class Asset:
    """An entry of the catalogue: all that is needed to place an object.

    Attributes
    ----------
    name : str
        Catalogue name, e.g. ``"chair_01"``.
    display_name : str
        As SAILenv wrote it, e.g. ``"Chair 01"``.
    category : str
        Name in the category table.
    model : Model
        All of it, its parts too. Body frame: x forward, y left, z up; origin at the centre of mass
        for primitives, at the centre of the base for furniture.
    collision : tuple of CollisionShape
        Compound of shapes; empty for what nothing collides with.
    mass_kg : float
        Mass if it may move [kg].
    centre_of_mass_m : (3,) tuple of float
        In the body frame [m].
    keypoints : tuple of (str, (3,) tuple of float)
        Named points in the body frame [m].
    parts : tuple of AssetPart
        No mesh belongs to two of them, and one at least to none: that is the body.
    moving : tuple of MovingPart
        What of it opens. `model` and `collision` have it too, closed: so the piece is drawn where
        it moves freely, in one body.
    still : Asset or None
        The piece without `moving`, which carries that on joints where it stands still.
    opens : bool
        True for what moves on a joint of its piece: its light is that of moving objects, and what
        lies behind it is lit.
    rig : Rig or None
        Skeleton by which the model deforms, if it has one.
    inertia : Inertia or None
        About the centre of mass; None takes that of the collision shapes.

    Raises
    ------
    AssetError
        If that is not so.
    """

    name: str
    display_name: str
    category: str
    model: Model
    collision: tuple[CollisionShape, ...]
    mass_kg: float = 1.0
    centre_of_mass_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    tags: tuple[str, ...] = field(default=())
    keypoints: tuple[tuple[str, tuple[float, float, float]], ...] = ()
    parts: tuple[AssetPart, ...] = ()
    moving: tuple[MovingPart, ...] = ()
    still: Asset | None = None
    opens: bool = False
    rig: Rig | None = None
    inertia: Inertia | None = None

    def __post_init__(self) -> None:
        taken = [place for part in self.parts for place in part.meshes]
        if len(set(taken)) != len(taken):
            raise AssetError(self.name, "a mesh belongs to two of its parts; one is accepted")
        if any(not part.meshes for part in self.parts):
            raise AssetError(self.name, "a part has no mesh; at least one is accepted")
        if len({part.name for part in self.parts}) != len(self.parts):
            raise AssetError(self.name, "two of its parts have the same name")
        if taken and not self._body_meshes:
            raise AssetError(self.name, "its parts take all meshes; one must be left to the body")

    @property
    def body_model(self) -> Model:
        """Visible geometry of the body: the model without its labelled parts."""
        return self.model.only(self._body_meshes)

    def part_model(self, part: AssetPart) -> Model:
        """Return what is drawn as one of its parts; the same object each time."""
        return self.model.only(part.meshes)

    def meshes_of(self, part: AssetPart | None) -> tuple[int, ...]:
        """Return the places in ``model.parts`` of a part's meshes; None: of the body's."""
        return self._body_meshes if part is None else part.meshes

    @property
    def _body_meshes(self) -> tuple[int, ...]:
        taken = {place for part in self.parts for place in part.meshes}
        return tuple(place for place in range(len(self.model.parts)) if place not in taken)


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class MovingPart:
    """A part of a piece that turns or slides, with the joint that carries it.

    Attributes
    ----------
    name : str
        Unique in its piece, e.g. ``"left door"``.
    asset : Asset
        In the piece's own frame, where it is while the joint's position is 0.
    type : {'hinge', 'slide'}
    axis : (3,) tuple of float
        Unit vector, in the piece's frame.
    origin_m : (3,) tuple of float
        A point of a hinge's axis [m].
    limits : (2,) tuple of float
        Least and greatest position [rad] or [m].
    friction, effort : float
        [N m] or [N].
    damping : float
        [N m s/rad] or [N s/m].
    soft_close, detents : SoftClose or None, Detents or None
    """

    name: str
    asset: Asset
    type: Literal["hinge", "slide"]
    axis: tuple[float, float, float]
    origin_m: tuple[float, float, float]
    limits: tuple[float, float]
    friction: float = 1.0
    effort: float = 100.0
    damping: float = 1.0
    soft_close: SoftClose | None = None
    detents: Detents | None = None
