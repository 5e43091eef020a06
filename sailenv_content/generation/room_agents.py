"""The agents of a generated room: one that goes the camera's way, others that look at the room.

A built `World` in, entries of a scene file out. Where they stand is chosen by the camera rule
`room_view`, and the way begins where its view is best, so the first frame shows something.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.authoring.viewpoints import ViewScene, sample_cameras
from sailenv_ros.authoring.viewpoints.room_view import view_score
from sailenv_ros.frame.truth.amodal_masks import AmodalMasks
from sailenv_ros.render.contract import RenderBackend, RenderRequest
from sailenv_ros.render.cpu.amodal_renderer import AmodalRenderer
from sailenv_ros.space import FreeSpace
from sailenv_ros.space.free_space import BodySize
from sailenv_ros.space.grid import map_free_space
from sailenv_ros.space.outlines import solids_of
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import look_at
from sailenv_ros.world.world import World

__all__ = ["StandingWorld", "agent_entries", "best_first"]

WALKER = "walker"
"""Follows the mover. A name that programs seldom have for agents of their own."""

VIEWS = "view"
FOV_DEG = 62.0
ATTEMPTS = 60

_LOOK_PX = (80, 60)


class StandingWorld(ViewScene):
    """A world that stands still, as rules of cameras see it.

    Parameters
    ----------
    world : World
    backend : RenderBackend
    """

    def __init__(self, world: World, backend: RenderBackend) -> None:
        width, height = _LOOK_PX
        lens = CameraIntrinsics(width=width, height=height, vertical_fov_deg=FOV_DEG)
        super().__init__(world.snapshot(), lens)
        self._world = world
        self._backend = backend

    def draw(self, camera: Camera, *views: str) -> Mapping[str, NDArray[Any]]:
        """Return these views of the world."""
        return self._backend.render(RenderRequest(self.snapshot, camera, views)).views

    def draw_amodal(self, camera: Camera, only: int) -> AmodalMasks:
        """Return each object drawn alone, or only the one of that id."""
        return AmodalRenderer().draw(self.snapshot, camera, only)

    def free_space(self, body: BodySize) -> FreeSpace:
        """Return where a body can stand."""
        solids = (
            solid
            for each in self._world.bodies
            for solid in solids_of(
                each.placement.asset.collision, each.placement.scale, each.world_from_body()
            )
        )
        return map_free_space(solids, body)


def agent_entries(scene: StandingWorld, count: int, seed: int) -> list[dict[str, Any]]:
    """Return the agents of a scene file: one on the camera's way, and up to so many that stand."""
    lens = {"vertical_fov": FOV_DEG, "rate": 0}
    entries: list[dict[str, Any]] = [{"name": WALKER, **lens}]
    views = sample_cameras(scene, "room_view", count, seed=seed, settings={"attempts": ATTEMPTS})
    for number, view in enumerate(views, start=1):
        position = [round(value, 2) for value in view.pose.position_m]
        rotation = [round(value) for value in view.pose.rpy_deg]
        name = VIEWS if number == 1 else f"{VIEWS}_{number}"
        entries.append(
            {"name": name, **lens, "following": False, "position": position, "rotation": rotation}
        )
    return entries


def best_first(scene: StandingWorld, waypoints: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the waypoints of a closed way, beginning where the view is best."""
    worth = [
        view_score(scene, look_at(point["position"], point["look_at"])).worth()
        for point in waypoints
    ]
    first = int(np.argmax(worth))
    return [*waypoints[first:], *waypoints[:first]]
