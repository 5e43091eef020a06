"""From where a room is looked at for what its shiny surfaces mirror, and who uses which view.

A snapshot comes in, points and the number of the point that each instance uses go out. The first
two points are in the middle of the room: one for what mirrors no lamps, one for what does; the
others are before polished metal.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.render.scene.baked_state import ROW_IDS
from sailenv_ros.render.scene.reflection_map import view_point
from sailenv_ros.types.lights import Light
from sailenv_ros.types.model import Model
from sailenv_ros.types.snapshot import DrawnInstance, WorldSnapshot

__all__ = ["LAMPLESS", "MIDDLE", "MOST", "ReflectionPoints"]

LAMPLESS, MIDDLE = 0, 1
"""Numbers of the points in the middle."""

MOST = 7
"""Points in a room. All places cost six small pictures for each light when a room is shown first.
"""

APART_M = 0.5
"""Polished metal nearer than this to a point needs none of its own."""

LARGE_M = 3.0
"""Instances of this diagonal, such as walls, mirror no lamps.

Seen from the room's middle a lamp lies elsewhere, and is larger, than from most of their places.
"""

BEFORE_M = 0.05
"""Distance of the point in front of the box around the metal [m]."""

INSIDE_M = 0.1
"""Points keep this distance from the walls, and above what stands at their place."""

CLEAR_M = 0.02
"""Points nearer than this to the box around an object count as inside."""

FAR_M = 1.2
"""Surfaces farther than this from all points use the point in the middle [m]."""

LEAST_METALLIC, MOST_ROUGHNESS = 0.5, 0.45


@dataclass(frozen=True, eq=False, slots=True)
class _Spot:
    """Reflective region of a model, before scaling."""

    middle: NDArray[np.float64]
    size: NDArray[np.float64]
    polished: bool


class ReflectionPoints:
    """The points of the scene that is shown.

    Attributes
    ----------
    points : (K, 3) float64
        World frame [m], at most `MOST`; `LAMPLESS` and `MIDDLE` are one place.
    box : (2, 3) float64
        Lowest and highest corner of the room [m].
    """

    def __init__(self) -> None:
        self._spots: dict[int, tuple[Model, _Spot]] = {}
        self._instances: tuple[DrawnInstance, ...] | None = None
        self._middles = np.zeros((0, 4))
        self._sizes = np.zeros(0)
        self._polished = np.zeros(0, np.bool_)
        self._table: NDArray[np.int32] = np.zeros(ROW_IDS, np.int32)
        self._of: tuple[object, bytes, object] | None = None
        self.points = np.zeros((2, 3))
        self.box = np.zeros((2, 3))

    def choose(self, snapshot: WorldSnapshot) -> None:
        """Choose points for a room with baked light, and where everything is now.

        The next point is before that polished metal which is farthest from all points so far,
        counting the size of the metal too.
        """
        contents = snapshot.contents
        assert contents.baked is not None
        self._show(contents.instances)
        middle, self.box = view_point(contents.baked.probes)
        found = [middle, middle]
        at = self._world(snapshot)
        mirrors = self._polished & ~self._is_lampless(at, contents.lights)
        at, size = at[mirrors], self._sizes[mirrors]
        towards = middle - at
        distance = np.maximum(np.linalg.norm(towards, axis=1, keepdims=True), 1e-6)
        step = np.minimum(0.5 * size[:, None] + BEFORE_M, distance)
        before = np.clip(
            at + towards / distance * step, self.box[0] + INSIDE_M, self.box[1] - INSIDE_M
        )
        self._lift(before, snapshot)
        nearest = np.linalg.norm(before - middle, axis=1)
        while len(found) < MOST and (nearest > APART_M).any():
            best = int(np.argmax(np.where(nearest > APART_M, nearest * np.sqrt(size), -1.0)))
            found.append(before[best])
            nearest = np.minimum(nearest, np.linalg.norm(before - before[best], axis=1))
        self.points = np.array(found)
        self._of = None

    def table(self, snapshot: WorldSnapshot) -> NDArray[np.int32]:
        """Return (R,) int32: by instance id, the number of the nearest point.

        R is a multiple of `ROW_IDS`. Another array when it has changed.
        """
        contents = snapshot.contents
        where = snapshot.world_from_body.tobytes() + self.points.tobytes()
        of = (contents.instances, where, contents.lights)
        if self._of == of:
            return self._table
        self._of = of
        self._show(contents.instances)
        at = self._world(snapshot)
        offsets = at[:, None] - self.points[MIDDLE:]
        squares = np.einsum("nkx,nkx->nk", offsets, offsets)
        nearest = np.where(squares.min(axis=1) < FAR_M**2, np.argmin(squares, axis=1), 0) + MIDDLE
        ids = contents.instance_ids.astype(np.intp)
        table = np.zeros((int(ids.max(initial=0)) // ROW_IDS + 1) * ROW_IDS, np.int32)
        table[ids] = np.where(self._is_lampless(at, contents.lights), LAMPLESS, nearest)
        if not np.array_equal(table, self._table):
            self._table = table
        return self._table

    def _show(self, instances: tuple[DrawnInstance, ...]) -> None:
        if instances is self._instances:
            return
        self._instances = instances
        self._spots = {
            id(drawn.model): self._spots.get(id(drawn.model)) or (drawn.model, _spot(drawn.model))
            for drawn in instances
        }
        spots = [self._spots[id(drawn.model)][1] for drawn in instances]
        scales = np.array([drawn.scale for drawn in instances]).reshape(-1, 3)
        self._middles = np.ones((len(spots), 4))
        self._middles[:, :3] = np.array([s.middle for s in spots]).reshape(-1, 3) * scales
        sizes = np.array([spot.size for spot in spots]).reshape(-1, 3) * scales
        self._sizes = np.linalg.norm(sizes, axis=1)
        self._polished = np.array([spot.polished for spot in spots], np.bool_)

    def _lift(self, points: NDArray[np.float64], snapshot: WorldSnapshot) -> None:
        """Move points that lie in the box around an object above it: inside, all is dark."""
        for drawn, pose in zip(snapshot.contents.instances, snapshot.world_from_body, strict=True):
            bounds = drawn.model.bounds() * np.asarray(drawn.scale)
            if np.linalg.norm(bounds[1] - bounds[0]) >= LARGE_M:
                continue
            # The box around the turned box.
            middle = pose[:3, :3] @ bounds.mean(axis=0) + pose[:3, 3]
            half = np.abs(pose[:3, :3]) @ (0.5 * (bounds[1] - bounds[0]))
            within = (np.abs(points - middle) < half + CLEAR_M).all(axis=1)
            points[within, 2] = middle[2] + half[2] + INSIDE_M
        points[:, 2] = np.minimum(points[:, 2], self.box[1, 2] - INSIDE_M)

    def _is_lampless(self, at: NDArray[np.float64], lights: Iterable[Light]) -> NDArray[np.bool_]:
        """Return (N,): which instances, that mirror at places, (N, 3), mirror no lamps.

        Those that are large, and those close behind an area light, where it does not shine, such
        as curtains: seen from before it they would mirror it.
        """
        lampless = self._sizes >= LARGE_M
        for light in lights:
            if light.type == "area":
                offsets = at - light.position_m
                diagonal_m = math.hypot(light.width_m, light.height_m)
                near = np.linalg.norm(offsets, axis=1) < diagonal_m
                lampless |= near & (offsets @ light.direction < 0.0)
        return lampless

    def _world(self, snapshot: WorldSnapshot) -> NDArray[np.float64]:
        """Return (N, 3): where each instance mirrors."""
        at: NDArray[np.float64] = np.einsum(
            "nij,nj->ni", snapshot.world_from_body[:, :3], self._middles
        )
        return at


def _spot(model: Model) -> _Spot:
    """Return the box around a model's polished metal; if there is none, around all of it."""
    boxes = [
        (part.mesh.positions.min(axis=0), part.mesh.positions.max(axis=0))
        for part in model.parts
        if len(part.mesh.positions)
        and part.material.alpha != "blend"
        and part.material.metallic >= LEAST_METALLIC
        and part.material.roughness <= MOST_ROUGHNESS
    ]
    low, high = model.bounds()
    if boxes:
        low = np.min([box[0] for box in boxes], axis=0)
        high = np.max([box[1] for box in boxes], axis=0)
    middle = 0.5 * (np.asarray(low, np.float64) + high)
    return _Spot(middle, np.asarray(high, np.float64) - low, bool(boxes))
