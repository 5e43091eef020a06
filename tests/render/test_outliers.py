"""Random views of the rooms: no pixel of walls, floors, ceilings and sills is dark alone."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from sailenv_ros.render.contract import RenderRequest
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.support.light_faults import bright_spots, dashes, outliers
from tests.support.plausible_views import plausible_views, room_at_rest

STRUCTURE = ("wall", "floor", "ceiling")
VIEWS = 20


def test_an_outlier_is_found() -> None:
    """One black pixel on a grey wall, and a line, which is none."""
    rgb = np.full((12, 16, 3), 200, np.uint8)
    rgb[5, 7] = 20
    rgb[9] = 20
    assert outliers(rgb, np.ones((12, 16), np.bool_)).tolist() == [[5, 7]]


def test_a_dash_is_found() -> None:
    """Darker pixels in a row by an edge, but neither the edge's shade nor the joint of tiles."""
    rgb, albedo = np.full((60, 80, 3), 180, np.uint8), np.full((60, 80, 3), 0.5, np.float32)
    surfaces = np.where(np.arange(60) < 30, 1, 2)[:, None] * np.ones(80, np.int64)
    rgb[29] = 150
    rgb[28:30, 40] = 130
    rgb[25:35, 60], albedo[25:35, 60] = 120, 0.2
    assert dashes(rgb, albedo, surfaces).tolist() == [[28, 40], [29, 40]]


def test_a_spot_is_found() -> None:
    """A blot of 30 pixels, but neither a slope of light nor the same blot of paint."""
    rgb = np.repeat(np.linspace(100, 120, 320).astype(np.uint8)[None], 240, 0)
    rgb = np.repeat(rgb[..., None], 3, axis=2)
    albedo = np.full(rgb.shape, 0.5, np.float32)
    v, u = np.mgrid[:240, :320]
    blot = (12 * np.exp(-((v - 100) ** 2 + (u - 150) ** 2) / 15.0**2)).astype(np.uint8)[..., None]
    surfaces = np.ones((240, 320), np.int64)
    assert not len(bright_spots(rgb, albedo, surfaces))
    assert not len(bright_spots(rgb + blot, albedo + blot / 64.0, surfaces))
    found = bright_spots(rgb + blot, albedo, surfaces)
    assert len(found)
    np.testing.assert_allclose(8 * found.mean(axis=0) + 4, [100, 150], atol=8)


@pytest.mark.parametrize("name", ["room_01", "room_02", "room_03"])
def test_no_pixel_stands_out_alone(name: str) -> None:
    """In 20 views of each room; handles of windows are no part of it.

    Dashes and spots are faults of baked light: `benchmarks/room_faults.py` counts them.
    """
    # Another test may have left the draft of a bake.
    room: WorldSnapshot = room_at_rest(name, baked_light=False)
    categories = [drawn.instance.category for drawn in room.contents.instances]
    ids = room.contents.instance_ids
    structure = ids[np.isin(categories, STRUCTURE)]
    windows = ids[np.isin(categories, "window")]
    renderer = NativeRenderer()
    found = []
    try:
        views = plausible_views(room, renderer, name, width=480, height=360)
        for number, camera in enumerate(itertools.islice(views, VIEWS)):
            wanted = ("rgb", "instance", "normals")
            seen = renderer.render(RenderRequest(room, camera, wanted)).views
            upwards = seen["normals"] @ camera.world_from_camera[2, :3] > 0.9
            sills = np.isin(seen["instance"], windows)
            plain = np.isin(seen["instance"], structure)
            at = outliers(seen["rgb"], plain | sills)
            own = ~sills | upwards
            found += [(number, *place) for place in at.tolist() if own[tuple(place)]]
    finally:
        renderer.close()
    assert found == []
