"""The present scene as camera rules see it: drawn by the simulation's own renderer.

No agent takes part, so nobody's next frame has another flow for it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from numpy.typing import NDArray

from sailenv_ros.authoring.viewpoints import ViewScene
from sailenv_ros.frame.truth.amodal_masks import AmodalMasks
from sailenv_ros.simulation.frame_maker import FrameMaker
from sailenv_ros.simulation.space_queries import SpaceQueries
from sailenv_ros.space import FreeSpace
from sailenv_ros.space.free_space import BodySize
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.snapshot import WorldSnapshot

__all__ = ["PresentScene"]


class PresentScene(ViewScene):
    """The scene of a simulation as it stands now.

    Parameters
    ----------
    snapshot : WorldSnapshot
        Of the present world.
    lens : CameraIntrinsics
    frames : FrameMaker
    space : SpaceQueries
        Asked about the same world.
    """

    def __init__(
        self,
        snapshot: WorldSnapshot,
        lens: CameraIntrinsics,
        frames: FrameMaker,
        space: SpaceQueries,
    ) -> None:
        super().__init__(snapshot, lens)
        self._frames = frames
        self._space = space

    def draw(self, camera: Camera, *views: str) -> Mapping[str, NDArray[Any]]:
        """Return these views of the scene."""
        return self._frames.look(camera, *views)

    def draw_amodal(self, camera: Camera, only: int) -> AmodalMasks:
        """Return each object drawn alone, or only the one of that id."""
        return self._frames.draw_amodal(self.snapshot, camera, only)

    def free_space(self, body: BodySize) -> FreeSpace:
        """Return where a body can stand."""
        return self._space.free_space(body)
