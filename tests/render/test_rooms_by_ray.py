"""The rooms' labels and depth against rays: every pixel that is not at an edge."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import look_at
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.render.conftest import Render
from tests.support.embree_cast import RayCast
from tests.support.picture_edges import grown, near_edges

pytestmark = pytest.mark.gl

VIEWS_PER_ROOM = 4
WIDTH, HEIGHT = 384, 288


@pytest.fixture(scope="module", params=["room_01", "room_02", "room_03"])
def room(request: pytest.FixtureRequest) -> Iterator[WorldSnapshot]:
    """A room after a second, when things have moved."""
    world = SceneLibrary().build(request.param)
    world.step(240)
    yield world.snapshot()
    world.close()


def test_labels_and_depth_are_what_rays_meet(room: WorldSnapshot, render: Render) -> None:
    """All ids away from edges, all depths away from edges to 1e-4, from places all about."""
    rays = RayCast(room)
    compared = 0
    for turn in np.arange(VIEWS_PER_ROOM) * 2.0 * np.pi / VIEWS_PER_ROOM + 0.4:
        eye = (1.1 * np.cos(turn), 1.0 * np.sin(turn), 1.5)
        target = (-1.5 * np.cos(turn), -1.5 * np.sin(turn), 0.7)
        camera = Camera(
            intrinsics=CameraIntrinsics(width=WIDTH, height=HEIGHT), pose=look_at(eye, target)
        )
        views = render(room, camera, "instance", "depth", "category")
        ids, depth, masked = rays.look(camera)
        inside = ~near_edges(ids, depth, 0.0005) & ~grown(masked)
        compared += int(inside.sum())
        assert (views["instance"][inside] == ids[inside]).all()
        table = room.contents.category_of_instance
        assert (views["category"][inside] == table[ids[inside]]).all()
        np.testing.assert_allclose(views["depth"][inside], depth[inside], rtol=1e-4)
    assert compared > 0.6 * VIEWS_PER_ROOM * WIDTH * HEIGHT
