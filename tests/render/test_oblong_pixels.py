"""Pixels that are not square: a picture of half as many rows is every second row of a square one.

Corners and focal lengths are sums of few powers of 2, as in `test_off_centre`.
"""

from __future__ import annotations

import numpy as np

from sailenv_ros.render.contract import RenderBackend
from sailenv_ros.render.cpu.amodal_renderer import AmodalRenderer
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.types.camera import Camera
from tests.render.conftest import Render
from tests.render.test_off_centre import HEIGHT, VIEWS, WIDTH, cards, crowd, two_instants, whole
from tests.support.tiny_scenes import camera_at, snapshot_of


def oblong() -> Camera:
    """The camera whose row v is row 2 v of the square one."""
    return camera_at(width=2 * WIDTH, height=HEIGHT, fx_px=32.0, fy_px=16.0, cy_offset_px=0.25)


def test_half_the_rows_are_every_second_row(render: Render, renderer: RenderBackend) -> None:
    """Byte by byte: ids, depth, normals, colours; flow is half as many pixels down.

    OpenGL snaps corners to parts of a pixel, so it is shown what has them there.
    """
    before, now = two_instants(crowd() if isinstance(renderer, NativeRenderer) else cards())
    square, half = whole(), oblong()
    expected = {
        view: values[::2]
        for view, values in render(now, square, *VIEWS, past=(before, square)).items()
    }
    expected["flow"] = expected["flow"] * np.array([1.0, 0.5], np.float32)
    found = render(now, half, *VIEWS, past=(before, half))
    assert len(np.unique(expected["instance"])) >= 5
    assert np.nanmax(np.abs(expected["flow"])) > 1.0
    for view in VIEWS:
        np.testing.assert_array_equal(found[view], expected[view], err_msg=view)


def test_objects_alone_have_every_second_row_too() -> None:
    """Each one's mask and depth."""
    now = snapshot_of(crowd())
    renderer = AmodalRenderer()
    large, small = renderer.draw(now, whole()), renderer.draw(now, oblong())
    renderer.close()
    for number in range(1, 6):
        np.testing.assert_array_equal(small.mask(number), large.mask(number)[::2])
