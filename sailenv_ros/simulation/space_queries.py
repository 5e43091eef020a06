"""Questions about the space of the present world: free places, and what rays meet.

Answers are kept until something moves, because one who asks for a way asks for several.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.rays.scene_geometry import SceneGeometry
from sailenv_ros.space.free_space import BodySize, FreeSpace
from sailenv_ros.space.grid import map_free_space
from sailenv_ros.space.outlines import Solid
from sailenv_ros.space.ray_hits import RayCast
from sailenv_ros.types.snapshot import SceneContents, WorldSnapshot
from sailenv_ros.world.crowd import solids_of_body
from sailenv_ros.world.world import World

__all__ = ["SpaceQueries", "solids_of_world"]

MOST_MAPS = 8
"""Maps of one instant that are kept."""


class SpaceQueries:
    """Answers questions about a world.

    Parameters
    ----------
    present : callable
        Returns the present world.
    """

    def __init__(self, present: Callable[[], World]) -> None:
        self._present = present
        self._mapped: WorldSnapshot | None = None
        self._maps: dict[BodySize, FreeSpace] = {}
        self._contents: SceneContents | None = None
        self._geometry = SceneGeometry({})

    def free_space(self, body: BodySize) -> FreeSpace:
        """Return where a body can stand as things stand now."""
        world = self._present()
        snapshot = world.snapshot()
        if snapshot is not self._mapped or len(self._maps) >= MOST_MAPS:
            self._mapped, self._maps = snapshot, {}
        if body not in self._maps:
            solids = solids_of_world(world)
            self._maps[body] = map_free_space(solids, body, stamp_ns=snapshot.sim_time_ns)
        return self._maps[body]

    def without_robots(self, body: BodySize) -> FreeSpace:
        """Return where a body can stand as things stand now, whatever robots stand there."""
        world = self._present()
        solids = (
            solid
            for one in world.bodies
            if not one.placement.robot
            for solid in solids_of_body(one)
        )
        return map_free_space(solids, body, stamp_ns=world.sim_time_ns)

    def cast_rays(self, origins: NDArray[np.float64], directions: NDArray[np.float64]) -> RayCast:
        """Return what rays (R, 3) meet first of what is drawn, as it stands now."""
        world = self._present()
        contents = world.contents
        if contents is not self._contents:
            self._contents, self._geometry = contents, SceneGeometry.of_contents(contents)
        return self._geometry.cast_surfaces(world.states(), origins, directions)


def solids_of_world(world: World) -> Iterator[Solid]:
    """Yield what physics knows of every body, as convex solids in the world."""
    for body in world.bodies:
        yield from solids_of_body(body)
