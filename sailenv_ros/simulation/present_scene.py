"""The present scene as camera rules see it: drawn by the simulation's own renderer.

No agent takes part, so nobody's next frame has another flow for it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from sailenv_ros.camera import Camera, CameraIntrinsics
from sailenv_ros.object_truth.amodal_masks import AmodalMasks
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

    def draw(self, camera: Camera, *views: str) -> Mapping[str, NDArray[Any]]:
        """Return these views of the scene."""
        return self._core.look(camera, *views)

    def draw_amodal(self, camera: Camera, only: int) -> AmodalMasks:
        """Return each object drawn alone, or only the one of that id."""
        return self._core.draw_amodal(self.snapshot, camera, only)

    def free_space(self, body: BodySize) -> FreeSpace:
        """Return where a body can stand."""
        return self._core.space.free_space(body)
