"""Where a camera and what moves stood at the instant of each row of a rolling shutter.

Made by `simulation/`, goes with an `Observation` to renderers and with a frame to its users.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.geometry import invert
from sailenv_ros.types.rebuilding import RebuiltByFields

__all__ = ["RowPoses"]


@dataclass(frozen=True, eq=False, kw_only=True)
class RowPoses(RebuiltByFields):
    """Poses by rows. Arrays are read-only.

    Attributes
    ----------
    times_ns : (H,) int64
        Simulated time of the middle of each row's exposure [ns].
    world_from_camera : (H, 4, 4) float64
        Optical frame of the camera at each row's instant.
    ids : (M,) uint16
        Instances that moved while the rows were exposed, ascending; all others stood still.
    world_from_instance : (H, M, 4, 4) float64
        Their poses, rigid.
    """

    times_ns: NDArray[np.int64]
    world_from_camera: NDArray[np.float64]
    ids: NDArray[np.uint16]
    world_from_instance: NDArray[np.float64]

    def __post_init__(self) -> None:
        for array in (self.times_ns, self.world_from_camera, self.ids, self.world_from_instance):
            array.flags.writeable = False

    @cached_property
    def camera_from_world(self) -> NDArray[np.float64]:
        """(H, 4, 4) float64: the inverses of `world_from_camera`."""
        return invert(self.world_from_camera)

    def of_instance(self, instance_id: int, otherwise: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return (H, 4, 4) float64: poses of one instance; `otherwise` (4, 4) if it stood still."""
        column = np.flatnonzero(self.ids == instance_id)
        if len(column):
            return self.world_from_instance[:, column[0]]
        return np.broadcast_to(otherwise, self.world_from_camera.shape)
