"""An optical axis off the picture's centre: its picture is a part of a larger centred one.

All corners are sums of few powers of 2, and so is the focal length: what the native rasteriser
computes is exact wherever the axis is, and a part has the very bytes of the whole. OpenGL's snaps
corners to a part of a pixel, so its depth is exact where it is one number all over a surface.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.render.contract import RenderBackend
from sailenv_ros.render.cpu.amodal_renderer import AmodalRenderer
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.model import Mesh
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.render.conftest import Render
from tests.support.tiny_scenes import (
    FRAME_NS,
    Thing,
    box_mesh,
    camera_at,
    contents_of,
    mesh_of,
    model_of,
    moved,
    snapshot_of,
    wall_mesh,
)

WIDTH, HEIGHT = 64, 96
PLACES = [(0, 0), (0, WIDTH), (HEIGHT, 0), (HEIGHT, WIDTH), (24, 5), (HEIGHT // 2, WIDTH // 2)]
"""First row and column of the part: in the corners the axis is as far away as it may be."""

PART_FOV_DEG, WHOLE_FOV_DEG = 112.61986494804043, 143.13010235415598
"""Angles whose focal length is 32 px to the last bit."""


def whole() -> Camera:
    """The larger camera, whose axis is in the centre."""
    return camera_at(width=2 * WIDTH, height=2 * HEIGHT, vertical_fov_deg=WHOLE_FOV_DEG)


def part(row: int, column: int) -> Camera:
    """The camera whose picture begins at this pixel of the larger one's."""
    camera = camera_at(
        width=WIDTH,
        height=HEIGHT,
        vertical_fov_deg=PART_FOV_DEG,
        cx_offset_px=float(WIDTH // 2 - column),
        cy_offset_px=float(HEIGHT // 2 - row),
    )
    assert camera.intrinsics.fx == whole().intrinsics.fx == 32.0
    return camera


def slanted(size: float, across: float) -> Mesh:
    """A parallelogram in the plane x + `across` y = 0 that faces -x."""
    right, up = np.array([across, -1.0, 0.0]) * size, np.array([0.0, 0.0, size])
    corners = [0.5 * (a * right + b * up) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    normal = (-1.0, -across, 0.0)
    uvs = [(0, 0), (1, 0), (1, 1), (0, 1)]
    return mesh_of(corners, [normal] * 4, uvs, [(0, 1, 2), (0, 2, 3)])


def crowd() -> list[Thing]:
    """A wall, and before it what stands everywhere up to the larger picture's rim.

    All that is seen lies in planes x = c, or at a distance from the eye that is a power of 2.
    """
    things = [*cards(), *(Thing(model_of(box_mesh(1.0)), thing.pose) for thing in cards()[1:])]
    for number, y in enumerate((-5.0, -1.0, 1.0, 5.0)):
        across = -1.0 if y < 0.0 else 1.0
        mesh = slanted(2.0, across)
        pose = Pose((8.0 - across * y, y, 0.25 * number))
        things.append(Thing(model_of(mesh, double_sided=True), pose))
    return things


def cards() -> list[Thing]:
    """A wall, and before it squares that face the eye."""
    square, wall = model_of(wall_mesh(1.0, 1.0)), model_of(wall_mesh(64.0, 64.0))
    things = [Thing(wall, Pose((8.0, 0.0, 0.0)))]
    for number, y in enumerate((-4.5, -2.5, -1.5, 1.5, 2.5, 4.5)):
        for z in (-8.5, -4.5, -1.5, 2.5, 4.5, 8.5):
            things.append(Thing(square, Pose((4.5 if number % 2 else 3.5, y, z))))
    return things


def two_instants(things: list[Thing]) -> tuple[WorldSnapshot, WorldSnapshot]:
    """Things before, and when they have come to their place."""
    contents = contents_of(things)
    steps = [(0.0, 0.125 * (k % 3 - 1), 0.125 * (k % 2)) for k in range(len(things))]
    there = [
        Pose(tuple(float(v) for v in np.subtract(thing.pose.position_m, step)))
        for thing, step in zip(things, steps, strict=True)
    ]
    before = snapshot_of(moved(things, *there), contents=contents)
    return before, snapshot_of(things, contents=contents, time_ns=FRAME_NS)


def cropped(views: dict[str, NDArray[Any]], row: int, column: int) -> dict[str, NDArray[Any]]:
    """Return the part of a whole picture's views."""
    window = slice(row, row + HEIGHT), slice(column, column + WIDTH)
    return {view: picture[window] for view, picture in views.items()}


VIEWS = ("instance", "category", "depth", "normals", "albedo", "flow")


def both(
    render: Render, things: list[Thing], place: tuple[int, int]
) -> tuple[dict[str, NDArray[Any]], dict[str, NDArray[Any]]]:
    """Return what the part's camera sees, and that part of what the larger one sees."""
    before, now = two_instants(things)
    large, small = whole(), part(*place)
    views = render(now, large, *VIEWS, past=(before, large))
    expected = cropped(views, *place)
    assert len(np.unique(expected["instance"])) >= 5
    assert np.abs(expected["flow"]).max() > 1.0
    return render(now, small, *VIEWS, past=(before, small)), expected


def pictures(
    render: Render, now: WorldSnapshot, place: tuple[int, int], settings: PictureSettings
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the part's picture and that part of the larger one, without the rim.

    At the rim OpenGL has no neighbours from which to take how fast textures change.
    """
    large, small = (replace(camera, picture=settings) for camera in (whole(), part(*place)))
    expected = cropped(render(now, large, "rgb"), *place)["rgb"]
    found = render(now, small, "rgb")["rgb"]
    return found[2:-2, 2:-2].astype(np.int64), expected[2:-2, 2:-2].astype(np.int64)


@pytest.mark.parametrize("place", PLACES)
def test_the_picture_is_that_part_of_a_larger_one(render: Render, place: tuple[int, int]) -> None:
    """Byte by byte: ids, categories, depth, normals, albedo, flow; nothing is culled wrongly."""
    found, expected = both(render, cards(), place)
    for view in VIEWS:
        np.testing.assert_array_equal(found[view], expected[view], err_msg=view)


@pytest.mark.parametrize("place", PLACES)
def test_surfaces_at_a_slant_are_that_part_too(
    render: Render, renderer: RenderBackend, place: tuple[int, int]
) -> None:
    """Byte by byte in the native renderer; in OpenGL's to the last bits of depth and flow."""
    found, expected = both(render, crowd(), place)
    native = isinstance(renderer, NativeRenderer)
    for view in VIEWS:
        if native or view not in ("depth", "flow"):
            np.testing.assert_array_equal(found[view], expected[view], err_msg=view)
    np.testing.assert_allclose(found["depth"], expected["depth"], rtol=2e-6)
    np.testing.assert_allclose(found["flow"], expected["flow"], rtol=1e-5, atol=1e-5)


@pytest.mark.parametrize("settings", [{}, {"supersampling": 2, "smooth_edges": False}])
@pytest.mark.parametrize("place", PLACES)
def test_the_light_is_that_part_too(
    render: Render, renderer: RenderBackend, place: tuple[int, int], settings: dict[str, Any]
) -> None:
    """Shadows, sky, smooth edges and supersampling: each follows the axis.

    Byte by byte in the native renderer; in OpenGL's but for a pixel here and there at edges.
    """
    _, now = two_instants(crowd())
    found, expected = pictures(render, now, place, PictureSettings(**settings))
    assert np.ptp(expected) > 40
    if isinstance(renderer, NativeRenderer):
        np.testing.assert_array_equal(found, expected)
    assert (found != expected).mean() < 0.002


@pytest.mark.parametrize("place", [(0, 0), (24, 5), (HEIGHT, WIDTH)])
def test_a_mirror_shows_that_part_of_the_room(render: Render, place: tuple[int, int]) -> None:
    """Seen from behind the mirror the axis is off to the other side."""
    metal = {"base_colour": (0.9, 0.8, 0.7, 1.0), "metallic": 1.0, "roughness": 0.02}
    mirror = Thing(model_of(box_mesh((0.25, 32.0, 32.0)), **metal), Pose((4.125, 0.0, 0.0)))
    lamp = model_of(box_mesh(1.0), base_colour=(0.0, 0.0, 0.0, 1.0), emission=(0.3, 0.2, 0.1))
    places = [(-4.5, y, z) for y in (-9.5, -2.5, 4.5) for z in (-12.5, 1.5, 9.5)]
    now = snapshot_of([mirror, *(Thing(lamp, Pose(at)) for at in places)], lights=())
    settings = PictureSettings(occlusion_strength=0.0, smooth_edges=False)
    found, expected = pictures(render, now, place, settings)
    assert np.ptp(expected) > 40
    assert (np.abs(found - expected) > 2).mean() < 0.002


@pytest.mark.parametrize("place", PLACES)
def test_objects_alone_are_that_part_too(place: tuple[int, int]) -> None:
    """Every object's mask and depth, whatever lies before it: byte by byte."""
    renderer = AmodalRenderer()
    _, now = two_instants(crowd())
    large, small = (renderer.draw(now, camera) for camera in (whole(), part(*place)))
    seen = 0
    for number in large.ids.tolist():
        expected = large.depth(number)[place[0] : place[0] + HEIGHT, place[1] : place[1] + WIDTH]
        np.testing.assert_array_equal(small.depth(number), expected)
        seen += np.isfinite(expected).any()
    assert seen >= 10
    renderer.close()
