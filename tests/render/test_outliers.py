"""Random views of the rooms: no pixel of walls, floors, ceilings and sills is black alone."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.cpu_render.cpu_renderer import NativeRenderer
from sailenv_ros.snapshot import WorldSnapshot
from tests.support.plausible_views import plausible_views, room_at_rest

STRUCTURE = ("wall", "floor", "ceiling")
VIEWS = 20
STANDS_OUT = 40
"""Luma, of 255, by which a pixel is darker than all eight around it."""


def outliers(rgb: NDArray[np.uint8], plain: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Return (N, 2): rows and columns of single pixels among pixels that are all `plain`."""
    luma = rgb.astype(int) @ np.array([77, 150, 29]) // 256
    rows, columns = luma.shape

    def beside(array: NDArray[np.generic]) -> NDArray[np.generic]:
        steps = [step for step in np.ndindex(3, 3) if step != (1, 1)]
        return np.array([array[v : v + rows - 2, u : u + columns - 2] for v, u in steps])

    own, around = luma[1:-1, 1:-1], beside(luma)
    found = own < around.min(axis=0) - STANDS_OUT
    return np.argwhere(found & plain[1:-1, 1:-1] & beside(plain).all(axis=0)) + 1


def test_an_outlier_is_found() -> None:
    """One black pixel on a grey wall, and a line, which is none."""
    rgb = np.full((12, 16, 3), 200, np.uint8)
    rgb[5, 7] = 20
    rgb[9] = 20
    assert outliers(rgb, np.ones((12, 16), np.bool_)).tolist() == [[5, 7]]


@pytest.mark.parametrize("name", ["room_01", "room_02", "room_03"])
def test_no_pixel_stands_out_alone(name: str) -> None:
    """In 20 views of each room; handles of windows are no part of it."""
    room: WorldSnapshot = room_at_rest(name)
    categories = [drawn.instance.category for drawn in room.contents.instances]
    ids = room.contents.instance_ids
    structure = ids[np.isin(categories, STRUCTURE)]
    windows = ids[np.isin(categories, "window")]
    renderer = NativeRenderer()
    found = []
    try:
        views = plausible_views(room, renderer, name, width=200, height=150)
        for number, camera in enumerate(itertools.islice(views, VIEWS)):
            wanted = ("rgb", "instance", "normals")
            seen = renderer.render(room, None, camera, wanted).views
            upwards = seen["normals"] @ camera.world_from_camera[2, :3] > 0.9
            sills = np.isin(seen["instance"], windows)
            at = outliers(seen["rgb"], np.isin(seen["instance"], structure) | sills)
            own = ~sills | upwards
            found += [(number, *place) for place in at.tolist() if own[tuple(place)]]
    finally:
        renderer.close()
    assert found == []
