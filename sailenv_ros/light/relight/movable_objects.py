"""Objects with light of their own, where they stand, and what stands near.

From snapshots to `PlacedObject`.

Few of many objects move from one snapshot to the next: what is known of the others is kept.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.relight.object_light import Place, PlacedObject
from sailenv_ros.rays.model_triangles import triangles_of
from sailenv_ros.types.digests import once
from sailenv_ros.types.model import Model
from sailenv_ros.types.snapshot import DrawnInstance, WorldSnapshot, steady_poses

__all__ = ["MovableObjects", "can_be_lit", "casts_shadows"]

DENSE = 0.2
"""Alpha from which the light on what is seen through shows: of nets, not of panes."""

NEAR_M = 0.25
"""Things whose balls are farther apart neither shade nor light each other [m]."""


def can_be_lit(drawn: DrawnInstance) -> bool:
    """Return whether something has light of its own: it keeps its shape, and has none in the map.

    That is what can move, and nets and other dense sheets that are seen through: maps have nothing
    of these.
    """
    if drawn.is_baked and not _is_dense_sheet(drawn.model):
        return False
    return not drawn.deforms and drawn.outside is None and drawn.model.triangle_count > 0


def _is_dense_sheet(model: Model) -> bool:
    looks = (part.material for part in model.parts)
    return all(look.alpha == "blend" and look.base_colour[3] >= DENSE for look in looks)


@once
def casts_shadows(model: Model) -> bool:
    """Return whether anything of a model stops light."""
    if any(part.material.alpha == "opaque" and len(part.mesh.triangles) for part in model.parts):
        return True
    return bool((triangles_of(model).passes == 0.0).any())


class MovableObjects:
    """Objects of one scene that have light of their own, at places that small motions leave.

    Attributes
    ----------
    things : list of PlacedObject
        The same objects as before where they stand and rest as before.
    places : list of Place
        Of each.
    radii : (N,) float64
        Of a ball around each [m].
    near : list of list of int
        Which others stand near each.
    around : list of tuple of Place
        Place of each, and of those that stand near it; the same tuples as before where these are.
    """

    def __init__(self) -> None:
        self.things: list[PlacedObject] = []
        self.places: list[Place] = []
        self.near: list[list[int]] = []
        self.around: list[tuple[Place, ...]] = []
        self._instances: tuple[DrawnInstance, ...] | None = None
        self._rows = np.zeros(0, np.intp)
        self._poses, self._moving = np.zeros((0, 4, 4)), np.zeros(0, np.bool_)
        self._centres, self.radii = np.zeros((0, 3)), np.zeros(0)
        self._close = np.zeros((0, 0), np.bool_)

    def follow(self, snapshot: WorldSnapshot) -> None:
        """Take in where things are."""
        instances = snapshot.contents.instances
        anew = instances is not self._instances
        if anew:
            self._instances = instances
            self._rows = np.flatnonzero([can_be_lit(drawn) for drawn in instances])
            count = len(self._rows)
            # No pose is that of before.
            self._poses, self._moving = np.full((count, 4, 4), np.nan), np.zeros(count, np.bool_)
            self._centres, self.radii = np.zeros((count, 3)), np.zeros(count)
            self._close = np.zeros((count, count), np.bool_)
            self.things, self.places = [], []
            self.near, self.around = [[] for _ in range(count)], [() for _ in range(count)]
        poses = steady_poses(snapshot.world_from_body[self._rows])
        moving = snapshot.moving[self._rows]
        moved = (poses != self._poses).any(axis=(1, 2))
        changed = np.flatnonzero(moved | (moving != self._moving)).tolist()
        self._poses, self._moving = poses, moving
        for number in changed:
            drawn = instances[self._rows[number]]
            thing = PlacedObject(
                id=drawn.instance.id,
                model=drawn.model,
                scale=drawn.scale,
                world_from_body=poses[number].copy(),
                moves=bool(moving[number]),
            )
            # Appended where the lists are new.
            self.things[number : number + 1] = [thing]
            self.places[number : number + 1] = [thing.place]
            self._centres[number], self.radii[number] = thing.ball
        if changed:
            self._take_in_neighbours(changed)

    def _take_in_neighbours(self, changed: list[int]) -> None:
        """Find which others stand near those that have changed, and the reverse."""
        moved = np.array(changed, np.intp)
        apart = np.linalg.norm(self._centres[moved, None] - self._centres, axis=2)
        close: NDArray[np.bool_] = apart < self.radii[moved, None] + self.radii + NEAR_M
        close[np.arange(len(moved)), moved] = False
        touched = np.zeros(len(self.near), np.bool_)
        touched[moved] = True
        touched |= np.logical_or.reduce(close | self._close[moved], axis=0)
        self._close[moved], self._close[:, moved] = close, close.T
        for number in np.flatnonzero(touched).tolist():
            near = self.near[number] = np.flatnonzero(self._close[number]).tolist()
            self.around[number] = (self.places[number], *(self.places[other] for other in near))
