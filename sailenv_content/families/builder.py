"""Where a piece is put together: forms with their material, labelled parts, and what opens.

A form collides as itself: a board as its box, others as their hulls. Mass and centre follow from
the volumes and densities.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from sailenv_content.families.hardware import Joint
from sailenv_content.families.materials import PieceMaterial
from sailenv_content.families.shaping import Floats, board, placed
from sailenv_ros.assets.hulls import convex_hull
from sailenv_ros.types.joints import Detents, SoftClose
from sailenv_ros.types.labels import PART_MARK
from sailenv_ros.types.model import BoxShape, CollisionShape, ConvexShape, Mesh

__all__ = ["Unfit", "Component", "PieceBuilder"]

Vector3 = tuple[float, float, float]
LEAST_SHIFT_M = 1e-5
"""Height above or below the floor that is left as it is [m]."""
Collides = Literal["hull", "box", "none"]


class Unfit(Exception):
    """A draw that makes no sound piece: another is made."""


@dataclass(slots=True, kw_only=True)
class Component:
    """All that belongs to one part of a piece, or to its body.

    Attributes
    ----------
    name : str
        ``"left door"``, ``"left door/handle"``; empty for the body.
    category : str
    joint : Joint or None
        Of what opens.
    meshes : list of (PieceMaterial, Mesh)
    shapes : list of CollisionShape
    mass_kg : float
    moment : (3,) float64
        Mass times centre [kg m].
    """

    name: str
    category: str
    joint: Joint | None = None
    meshes: list[tuple[PieceMaterial, Mesh]] = field(default_factory=list)
    shapes: list[CollisionShape] = field(default_factory=list)
    mass_kg: float = 0.0
    moment: Floats = field(default_factory=lambda: np.zeros(3))


class PieceBuilder:
    """Puts one piece together.

    Attributes
    ----------
    rng : numpy.random.Generator
        For all that is random beside the parameters.
    components : list of Component
        The body first.
    keypoints : dict of str to (3,) tuple of float
    """

    def __init__(self, rng: np.random.Generator) -> None:
        self.rng = rng
        self.components = [Component(name="", category="")]
        self.keypoints: dict[str, Vector3] = {}
        self._at = self.components[0]
        self._frame = _Frame()

    # -- forms -----------------------------------------------------------------------------

    def box(
        self,
        material: PieceMaterial,
        size: ArrayLike,
        at: ArrayLike,
        *,
        turn: ArrayLike = (0.0, 0.0, 0.0),
        bevel: float = 0.002,
        top: tuple[float, float] = (1.0, 1.0),
        lean: tuple[float, float] = (0.0, 0.0),
        collides: bool = True,
    ) -> None:
        """Add a board: its size, and where its middle is [m]; see `shaping.board`."""
        sides = np.asarray(size, np.float64)
        if not (np.isfinite(sides).all() and (sides > 0.0).all()):
            raise Unfit(f"a board of {sides.tolist()} m")
        u, v = self.rng.uniform(0.0, 1.0, 2).tolist()
        x, y, z = sides.tolist()
        mesh = board(
            (x, y, z), bevel=bevel, tile_m=material.tile_m, shift=(u, v), top=top, lean=lean
        )
        mesh = self._frame.mesh(placed(mesh, at, turn))
        plain = top == (1.0, 1.0) and lean == (0.0, 0.0)
        self._add(material, mesh, float(sides.prod()))
        if collides and plain:
            self.collide(sides, at, turn)
        elif collides:
            self._at.shapes.append(convex_hull(mesh.positions.astype(np.float64)))

    def form(
        self,
        material: PieceMaterial,
        mesh: Mesh,
        at: ArrayLike = (0.0, 0.0, 0.0),
        *,
        turn: ArrayLike = (0.0, 0.0, 0.0),
        collides: Collides = "hull",
        volume: float | None = None,
    ) -> None:
        """Add any form; `volume` [m³] is that of its triangles unless it is given."""
        mesh = self._frame.mesh(placed(mesh, at, turn))
        self._add(material, mesh, _volume(mesh) if volume is None else volume)
        if collides == "hull":
            self._at.shapes.append(convex_hull(mesh.positions.astype(np.float64)))
        elif collides == "box":
            low, high = mesh.positions.min(axis=0), mesh.positions.max(axis=0)
            self._at.shapes.append(_box_shape(high - low, (low + high) / 2.0))

    def collide(self, size: ArrayLike, at: ArrayLike, turn: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        """Add a box that collides and is not drawn: for what is drawn without collision."""
        sides, place = np.asarray(size, np.float64), np.asarray(at, np.float64)
        self._at.shapes.append(self._frame.box_shape(sides, place, np.asarray(turn, np.float64)))

    def hull(self, mesh: Mesh, at: ArrayLike, *, turn: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        """Add the hull of a form that is not drawn, for what is drawn without collision."""
        mesh = self._frame.mesh(placed(mesh, at, turn))
        self._at.shapes.append(convex_hull(mesh.positions.astype(np.float64)))

    def collide_points(self, points: ArrayLike) -> None:
        """Add the hull of points (N, 3), all of them corners of it, that is not drawn."""
        corners = np.array([self._frame.point(point) for point in np.asarray(points, np.float64)])
        self._at.shapes.append(ConvexShape(points=corners))

    @contextmanager
    def frame(self, at: ArrayLike = (0.0, 0.0, 0.0), yaw_deg: float = 0.0) -> Iterator[None]:
        """Place all that is added inside: turned about z [deg], then shifted [m]."""
        before = self._frame
        self._frame = _Frame(before.point(at), before.yaw_deg + yaw_deg)
        try:
            yield
        finally:
            self._frame = before

    def set_down(self) -> None:
        """Move all so that the lowest point that is drawn is at z = 0: legs are cut off aslant."""
        drawn = [mesh.positions for one in self.components for _, mesh in one.meshes]
        low = min((float(positions[:, 2].min()) for positions in drawn), default=0.0)
        if abs(low) < LEAST_SHIFT_M:
            return
        by = np.array([0.0, 0.0, -low])
        for one in self.components:
            one.meshes = [(material, placed(mesh, by)) for material, mesh in one.meshes]
            one.shapes = [_shifted(shape, by) for shape in one.shapes]
            one.moment = one.moment + one.mass_kg * by
            if one.joint is not None:
                x, y, z = (np.asarray(one.joint.origin_m) + by).tolist()
                one.joint = replace(one.joint, origin_m=(x, y, z))
        self.keypoints = {name: (x, y, z - low) for name, (x, y, z) in self.keypoints.items()}

    # -- parts -----------------------------------------------------------------------------

    @contextmanager
    def part(self, name: str, category: str) -> Iterator[None]:
        """Label all that is added inside as a part; inside a part, as a part of that."""
        with self._adding_to(name, category):
            yield

    @contextmanager
    def hinge(
        self,
        name: str,
        category: str,
        *,
        at: ArrayLike,
        axis: Vector3,
        opens_deg: float,
        friction: float = 0.3,
        damping: float = 0.3,
        soft_close: SoftClose | None = None,
        detents: Detents | None = None,
    ) -> Iterator[None]:
        """Add a part that turns by up to an angle about an axis through a point."""
        x, y, z = self._frame.point(at).tolist()
        joint = Joint(
            type="hinge",
            axis=self._frame.direction(axis),
            origin_m=(x, y, z),
            limits=(0.0, math.radians(opens_deg)),
            friction=friction,
            effort=40.0,
            damping=damping,
            soft_close=soft_close,
            detents=detents,
        )
        with self._adding_to(name, category, joint):
            yield

    @contextmanager
    def slide(
        self,
        name: str,
        category: str,
        *,
        by: float,
        axis: Vector3 = (1.0, 0.0, 0.0),
        back: float = 0.0,
        friction: float = 2.0,
        damping: float = 4.0,
        soft_close: SoftClose | None = None,
        detents: Detents | None = None,
    ) -> Iterator[None]:
        """Add a part that slides by up to a length, and back by another [m]."""
        joint = Joint(
            type="slide",
            axis=self._frame.direction(axis),
            origin_m=(0.0, 0.0, 0.0),
            limits=(-round(back, 4), round(by, 4)),
            friction=friction,
            effort=80.0,
            damping=damping,
            soft_close=soft_close,
            detents=detents,
        )
        with self._adding_to(name, category, joint):
            yield

    @contextmanager
    def _adding_to(self, name: str, category: str, joint: Joint | None = None) -> Iterator[None]:
        component = Component(name=self._named(name), category=category, joint=joint)
        before, self._at = self._at, component
        self.components.append(component)
        try:
            yield
        finally:
            self._at = before

    def _named(self, name: str) -> str:
        outer = self._at.name
        taken = {component.name for component in self.components}
        whole = f"{outer}{PART_MARK}{name}" if outer else name
        number, free = 1, whole
        while free in taken:
            number += 1
            free = f"{whole} {number}"
        return free

    def chance(self, share: float) -> bool:
        """Return whether something is so that is so with this probability."""
        return bool(self.rng.uniform() < share)

    def pick(self, *values: Any) -> Any:
        """Return one of some values."""
        return values[int(self.rng.integers(len(values)))]

    def between(self, least: float, most: float) -> float:
        """Return a number between two."""
        return float(self.rng.uniform(least, most))

    def _add(self, material: PieceMaterial, mesh: Mesh, volume: float) -> None:
        component = self._at
        component.meshes.append((material, mesh))
        mass = max(volume, 1e-7) * material.density
        middle = (mesh.positions.min(axis=0) + mesh.positions.max(axis=0)).astype(np.float64) / 2.0
        component.mass_kg += mass
        component.moment = component.moment + mass * middle


@dataclass(frozen=True, slots=True)
class _Frame:
    """Where forms are put: turned about z, then shifted."""

    at: Floats = field(default_factory=lambda: np.zeros(3))
    yaw_deg: float = 0.0

    def mesh(self, mesh: Mesh) -> Mesh:
        """Return a mesh in the piece's own frame."""
        if not self.yaw_deg and not self.at.any():
            return mesh
        return placed(mesh, self.at, (0.0, 0.0, self.yaw_deg))

    def point(self, at: ArrayLike) -> Floats:
        """Return a point in the piece's own frame [m]."""
        return np.asarray(self._turned(np.asarray(at, np.float64)) + self.at)

    def direction(self, axis: Vector3) -> Vector3:
        """Return a unit vector in the piece's own frame."""
        x, y, z = self._turned(np.asarray(axis, np.float64)).tolist()
        return x, y, z

    def box_shape(self, size: Floats, at: Floats, turn: Floats) -> BoxShape:
        """Return a box that collides in the piece's own frame."""
        if not self.yaw_deg:
            return _box_shape(size, at + self.at, turn)
        whole = Rotation.from_euler("z", self.yaw_deg, degrees=True) * Rotation.from_euler(
            "xyz", turn, degrees=True
        )
        return _box_shape(size, self.point(at), whole.as_euler("xyz", degrees=True))

    def _turned(self, vector: Floats) -> Floats:
        quarters = self.yaw_deg / 90.0
        if quarters == round(quarters):  # exactly along the axes
            for _ in range(int(quarters) % 4):
                vector = np.array([-vector[1], vector[0], vector[2]])
            return vector
        turn = Rotation.from_euler("z", self.yaw_deg, degrees=True)
        return np.asarray(turn.apply(vector), np.float64)


def _shifted(shape: CollisionShape, by: Floats) -> CollisionShape:
    if isinstance(shape, ConvexShape):
        return ConvexShape(points=shape.points + by)
    assert isinstance(shape, BoxShape)  # no other is made here
    x, y, z = (np.asarray(shape.centre_m) + by).tolist()
    return replace(shape, centre_m=(x, y, z))


def _box_shape(size: NDArray[Any], at: ArrayLike, turn: ArrayLike = (0.0, 0.0, 0.0)) -> BoxShape:
    hx, hy, hz = (np.asarray(size, np.float64) / 2.0).tolist()
    x, y, z = np.asarray(at, np.float64).tolist()
    angles = np.asarray(turn, np.float64)
    quat = (0.0, 0.0, 0.0, 1.0)
    if angles.any():
        qx, qy, qz, qw = Rotation.from_euler("xyz", angles, degrees=True).as_quat().tolist()
        quat = (qx, qy, qz, qw)
    return BoxShape(half_extents_m=(hx, hy, hz), centre_m=(x, y, z), orientation_xyzw=quat)


def _volume(mesh: Mesh) -> float:
    a, b, c = (mesh.positions[mesh.triangles[:, k]].astype(np.float64) for k in range(3))
    return abs(float(np.einsum("ij,ij->", a, np.cross(b, c)))) / 6.0
