"""Poses that bodies had as they left the world, or were removed from it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import PhysicsError
from sailenv_ros.world.bodies import Body
from sailenv_ros.world.inactive_objects import InactiveObjects

__all__ = ["LastPoses"]


class LastPoses:
    """Keeps a pose for each instance id that was noted."""

    def __init__(self) -> None:
        self._kept: dict[int, NDArray[np.float64]] = {}

    def of(
        self, body_id: int, present: Body | None, waiting: InactiveObjects
    ) -> NDArray[np.float64]:
        """Return the (4, 4) pose of a body now, else its last one, else where it will be."""
        if present is not None:
            return present.world_from_body()
        if body_id in self._kept:
            return self._kept[body_id]
        return waiting[body_id].pose.matrix()

    def note(self, body_id: int, leaving: Body | None, waiting: InactiveObjects) -> None:
        """Keep where a body is that is about to go; where it was placed if that is not finite."""
        try:
            self._kept[body_id] = self.of(body_id, leaving, waiting).copy()
        except PhysicsError:
            assert leaving is not None
            self._kept[body_id] = leaving.entry_pose.matrix()
