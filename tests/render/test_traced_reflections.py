"""What rays from polished surfaces meet, against optics: where, how bright, and at once."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.native.library import load_library, using_instruction_set
from sailenv_ros.render.contract import RenderRequest
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Environment
from sailenv_ros.types.picture_settings import PictureSettings
from tests.support.baked import baked, chart, layer
from tests.support.picture import linear
from tests.support.tiny_scenes import (
    Thing,
    box_mesh,
    camera_at,
    model_of,
    snapshot_of,
    wall_mesh,
)

BLACK = Environment(
    ambient=(0, 0, 0), sky_zenith=(0, 0, 0), sky_horizon=(0, 0, 0), sky_ground=(0, 0, 0),
    background="colour", background_colour=(0, 0, 0),
)  # fmt: skip
TINT = (0.9, 0.8, 0.7)
BACK_WALL = Thing(
    model_of(wall_mesh(8.0, 8.0), base_colour=(0.5, 0.5, 0.5, 1.0)), Pose((9.0, 0.0, 0.0))
)
METAL = Thing(
    model_of(box_mesh((1.0, 2.0, 2.0)), base_colour=(*TINT, 1.0), metallic=1.0, roughness=0.06),
    Pose((3.5, 0.0, 0.0)),
)
"""Its front is at x = 3; it is too thick for a flat mirror."""
GLOW = (0.3, 0.2, 0.1)
LAMP = model_of(box_mesh(0.8), base_colour=(0.0, 0.0, 0.0, 1.0), emission=GLOW)
CARD = model_of(box_mesh((0.02, 1.2, 1.2)), base_colour=(0.0, 0.0, 0.0, 1.0), roughness=1.0)
PLAIN = PictureSettings(occlusion_strength=0.0, smooth_edges=False)


def camera() -> Camera:
    """At the origin, looking at the metal."""
    return replace(camera_at(width=160, height=120), picture=PLAIN)


def picture(native: NativeRenderer, *things: Thing) -> NDArray[np.uint8]:
    """In a dark baked room whose far wall alone has a chart."""
    light = baked({1: chart(BACK_WALL.model, BACK_WALL.pose)}, [], layer(None))
    scene = snapshot_of([BACK_WALL, *things], lights=(), environment=BLACK, baked=light)
    rgb: NDArray[np.uint8] = native.render(RenderRequest(scene, camera(), ("rgb",))).views["rgb"]
    return rgb


def place_of(point: tuple[float, float, float]) -> tuple[int, int]:
    """Row and column where a mirror at x = 3 shows a point."""
    x, y, z = point
    lens = camera().intrinsics
    ahead = 6.0 - x
    return round(lens.cy - lens.fy * z / ahead), round(lens.cx - lens.fx * y / ahead)


def around(rgb: NDArray[np.uint8], at: tuple[int, int]) -> NDArray[np.float64]:
    """Mean radiance of 5 x 5 pixels."""
    row, column = at
    part: NDArray[np.float64] = linear(rgb)[row - 2 : row + 3, column - 2 : column + 3]
    return part.mean(axis=(0, 1))


@pytest.mark.parametrize("place", [(-1.0, 0.8, 0.3), (-0.8, -0.7, 0.5)])
def test_metal_mirrors_what_stands_before_it(
    native: NativeRenderer, place: tuple[float, float, float]
) -> None:
    """Where optics says, left on the left, its radiance times the metal's colour."""
    rgb = picture(native, METAL, Thing(LAMP, Pose(place)))
    # Of the lamp the face towards the metal is seen, 0.4 m before its middle.
    seen = place_of((place[0] + 0.4, place[1], place[2]))
    np.testing.assert_allclose(around(rgb, seen), np.multiply(GLOW, TINT), rtol=0.08)
    beside = place_of((place[0] + 0.4, -place[1], -place[2]))
    assert around(rgb, beside).max() < 0.02


def test_what_moves_moves_in_the_metal_in_the_same_frame(native: NativeRenderer) -> None:
    """The renderer keeps what it knows of the scene; only the pose is another."""
    before, after = (-1.0, 0.8, 0.3), (-1.0, -0.8, -0.3)
    for here, there in ((before, after), (after, before)):
        rgb = picture(native, METAL, Thing(LAMP, Pose(here)))
        assert around(rgb, place_of((-0.6, *here[1:]))).max() > 0.2
        assert around(rgb, place_of((-0.6, *there[1:]))).max() < 0.02


def test_what_is_hidden_from_the_metal_is_not_mirrored(native: NativeRenderer) -> None:
    """A card between lamp and metal, beside the camera's view."""
    lamp = Thing(LAMP, Pose((-1.0, 0.9, 0.0)))
    free = picture(native, METAL, lamp)
    hidden = picture(native, METAL, lamp, Thing(CARD, Pose((-0.4, 0.9, 0.0))))
    seen = place_of((-0.6, 0.9, 0.0))
    assert around(free, seen).max() > 0.2
    assert around(hidden, seen).max() < 0.02


def test_a_pane_mirrors_four_hundredths(native: NativeRenderer) -> None:
    """Schlick's reflectance head-on, of the one face that it has."""
    pane = Thing(
        model_of(
            wall_mesh(2.0, 2.0), base_colour=(1.0, 1.0, 1.0, 0.0), alpha="blend", roughness=0.05
        ),
        Pose((3.0, 0.0, 0.0)),
    )
    bright = model_of(box_mesh(0.8), base_colour=(0.0, 0.0, 0.0, 1.0), emission=(9.0, 6.0, 3.0))
    place = (-1.0, 0.3, 0.1)
    with_lamp = picture(native, pane, Thing(bright, Pose(place)))
    seen = place_of((-0.6, *place[1:]))
    np.testing.assert_allclose(around(with_lamp, seen), (0.36, 0.24, 0.12), rtol=0.1)


def test_frames_do_not_depend_on_threads_or_the_instruction_set() -> None:
    """Rays are shared within bands, which are the same for any number of threads."""
    things = METAL, Thing(LAMP, Pose((-1.0, 0.8, 0.3)))
    made = set()
    for name, threads in itertools.product(load_library().instruction_sets, (1, 3)):
        with using_instruction_set(name):
            renderer = NativeRenderer(threads=threads)
            made.add(picture(renderer, *things).tobytes())
            renderer.close()
    assert len(made) == 1
