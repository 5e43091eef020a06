"""The present scene as camera rules see it: drawn by the simulation's own renderer.

No agent takes part, so nobody's next frame has another flow for it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.camera import CameraIntrinsics
from sailenv_ros.geometry import Pose
from sailenv_ros.space import FreeSpace
from sailenv_ros.space.free_space import BodySize
from sailenv_ros.viewpoints import ViewScene

if TYPE_CHECKING:
    from sailenv_ros.simulation.core import SimulationCore

__all__ = ["PresentScene"]


class PresentScene(ViewScene):
    """The scene of a simulation as it stands now.

    Parameters
    ----------
    core : SimulationCore
    lens : CameraIntrinsics
    """

    def __init__(self, core: SimulationCore, lens: CameraIntrinsics) -> None:
        super().__init__(core.world.snapshot(), lens)
        self._core = core
        self._last: tuple[Pose, Mapping[str, NDArray[Any]]] | None = None

    def instances(self, pose: Pose) -> NDArray[np.uint16]:
        """Return the (H, W) instance view from a pose."""
        return self._surfaces(pose)["instance"]

    def depth_m(self, pose: Pose) -> NDArray[np.float32]:
        """Return the (H, W) depth view from a pose [m]."""
        return self._surfaces(pose)["depth"]

    def whole_pixels(self, pose: Pose, only: int = 0) -> Mapping[int, int]:
        """Return how many pixels each object would cover alone; see `ViewScene`."""
        masks = self._core.draw_alone(self.snapshot, self.camera(pose), only)
        return dict(zip(masks.ids.tolist(), masks.whole_pixels.tolist(), strict=True))

    def free_space(self, body: BodySize) -> FreeSpace:
        """Return where a body can stand."""
        return self._core.space.free_space(body)

    def _surfaces(self, pose: Pose) -> Mapping[str, NDArray[Any]]:
        """Return depth and ids; rules ask for both, and what they cost is to draw the surfaces."""
        if self._last is None or self._last[0] is not pose:
            self._last = pose, self._core.look(self.camera(pose), "depth", "instance")
        return self._last[1]
