"""Small things that shine in a closed black box, against the form factors of their sides."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

from sailenv_ros.light.bake.area_light import form_factors
from sailenv_ros.light.bake.emitters import without_nested
from sailenv_ros.light.bake.pipeline import bake
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Light
from tests.support.bake_scenes import COARSE, hollow, read, still
from tests.support.tiny_scenes import Thing, box_mesh, mesh_of, model_of

SIDE_M = 0.06
RADIANCE = 50.0


def cube_light(points: np.ndarray, normals: np.ndarray, middle: np.ndarray) -> np.ndarray:
    """Irradiance / pi from a cube of which each side sends out the same radiance."""
    total = np.zeros(len(points))
    for axis in range(3):
        for sign in (-1.0, 1.0):
            out = sign * np.eye(3)[axis]
            side = Light(
                name="side", type="area", position_m=tuple(middle + SIDE_M / 2 * out),
                direction=tuple(out), width_m=SIDE_M, height_m=SIDE_M,
            )  # fmt: skip
            total += form_factors(side, points.astype(np.float32), normals.astype(np.float32))
    return RADIANCE * total


@pytest.mark.parametrize("middle", [(0.1, -0.2, 0.3), (0.9, 0.4, -1.1)])
def test_a_small_emitter_lights_by_its_form_factor(middle: tuple[float, float, float]) -> None:
    """A cube of 6 cm, which a thousandth of all rays meets, lights walls with little noise."""
    black = {"base_colour": (0.0, 0.0, 0.0, 1.0), "metallic": 1.0}
    cube = model_of(box_mesh(SIDE_M), **black, emission=(RADIANCE,) * 3)
    things = [Thing(hollow(3.0, **black)), Thing(cube, Pose(middle))]
    snapshot = still(things, lights=())
    baked = bake(snapshot, settings=replace(COARSE, texel_m=0.05))
    points, bounced = read(baked, 1, snapshot, baked.layers[0].bounced, steps=12)
    axis = np.argmax(np.abs(points), axis=1)
    normals = -np.sign(points) * np.eye(3)[axis]
    expected = cube_light(points, normals, np.array(middle))
    # In the walls' edges, and near the cube, light changes within a texel.
    chosen = np.sort(np.abs(points), axis=1)[:, 1] < 1.3
    chosen &= np.linalg.norm(points - np.array(middle), axis=1) > 0.8
    error = bounced[chosen][:, 0] / expected[chosen] - 1.0
    assert error.mean() == pytest.approx(0.0, abs=0.02)
    assert error.std() < 0.06


def test_looking_at_emitters_neither_adds_nor_takes_light() -> None:
    """In a furnace, a lamp within that shines as the walls do is not seen."""
    look = {"base_colour": (0.5, 0.5, 0.5, 1.0), "metallic": 1.0, "emission": (1.0, 1.0, 1.0)}
    lamp = model_of(box_mesh(0.2), **look)
    things = [Thing(hollow(3.0, **look)), Thing(lamp, Pose((0.1, -0.2, 0.3)))]
    snapshot = still(things, lights=())
    baked = bake(snapshot, settings=COARSE)
    for instance in (1, 2):
        _, bounced = read(baked, instance, snapshot, baked.layers[0].bounced)
        np.testing.assert_allclose(bounced, 2.0, rtol=0.04)
        np.testing.assert_allclose(bounced.mean(), 2.0, rtol=0.01)


def test_a_mirror_lights_walls_by_the_image_of_what_shines() -> None:
    """A wall opposite gets what a second cube behind the mirror would give, times its tint."""
    black = {"base_colour": (0.0, 0.0, 0.0, 1.0), "metallic": 1.0}
    middle = np.array([0.1, -0.2, 0.3])
    cube = model_of(box_mesh(SIDE_M), **black, emission=(RADIANCE,) * 3)
    silver = {"base_colour": (0.8, 0.8, 0.8, 1.0), "metallic": 1.0, "roughness": 0.02}
    mirror = Thing(model_of(box_mesh((0.02, 2.98, 2.98)), **silver), Pose((-1.48, 0.0, 0.0)))
    things = [Thing(hollow(3.0, **black)), Thing(cube, Pose(tuple(middle))), mirror]
    snapshot = still(things, lights=())
    baked = bake(snapshot, settings=replace(COARSE, texel_m=0.05))
    points, bounced = read(baked, 1, snapshot, baked.layers[0].bounced, steps=12)
    chosen = (points[:, 0] > 1.45) & (np.abs(points[:, 1:]).max(axis=1) < 1.3)
    points, normals = points[chosen], np.tile((-1.0, 0.0, 0.0), (chosen.sum(), 1))
    image = middle * (-1.0, 1.0, 1.0) - (2.0 * 1.47, 0.0, 0.0)
    straight, mirrored = (cube_light(points, normals, place) for place in (middle, image))
    assert (0.8 * mirrored / straight).max() > 0.1
    error = bounced[chosen][:, 0] / (straight + 0.8 * mirrored) - 1.0
    assert error.mean() == pytest.approx(0.0, abs=0.02)
    assert error.std() < 0.06


def roughness_of(points: np.ndarray, values: np.ndarray) -> float:
    """How far the light of the four upright walls is from smooth, over itself (RMS)."""
    found = []
    for axis, sign in itertools.product((0, 1), (-1.0, 1.0)):
        chosen = (sign * points[:, axis] > 1.49) & (np.abs(points[:, 1 - axis]) < 1.3)
        chosen &= np.abs(points[:, 2]) < 1.0
        across, up = points[chosen, 1 - axis], points[chosen, 2]
        basis = np.stack([across**i * up**j for i in range(7) for j in range(7 - i)], axis=1)
        smooth = basis @ np.linalg.lstsq(basis, values[chosen], rcond=None)[0]
        found.append(values[chosen] / smooth - 1.0)
    return float(np.sqrt(np.mean(np.concatenate(found) ** 2)))


def test_a_stem_through_a_lamp_leaves_neither_blots_nor_bands() -> None:
    """What it reflects comes from a centimetre of it; its shadows are as wide as the room."""
    black = {"base_colour": (0.0, 0.0, 0.0, 1.0), "metallic": 1.0}
    stem = model_of(box_mesh((0.02, 0.02, 0.6)), base_colour=(1.0, 1.0, 1.0, 1.0))
    lamp = Light(name="lamp", type="point", position_m=(0.0, 0.0, 0.0), intensity=1.0)
    snapshot = still([Thing(hollow(3.0, **black)), Thing(stem)], lights=(lamp,))
    baked = bake(snapshot, settings=replace(COARSE, texel_m=0.05))
    points, bounced = read(baked, 1, snapshot, baked.layers[1].bounced, steps=24)
    assert roughness_of(points, bounced[:, 0]) < 0.15
    points, direct = read(baked, 1, snapshot, baked.layers[1].direct, steps=24)
    assert roughness_of(points, direct) < 0.02


def test_each_bulb_of_a_chandelier_is_an_emitter() -> None:
    """Not the ball around all of them, of which they fill little."""
    black = {"base_colour": (0.0, 0.0, 0.0, 1.0), "metallic": 1.0}
    cube, places = box_mesh(SIDE_M), np.array([(-0.4, 0.0, 0.0), (0.0, 0.1, 0.0), (0.4, 0.0, 0.0)])
    count = len(cube.positions)
    bulbs = mesh_of(
        np.concatenate([cube.positions + place for place in places]),
        np.tile(cube.normals, (3, 1)),
        np.concatenate([(cube.uvs + np.array((k, 0.0))) / (3.0, 1.0) for k in range(3)]),
        np.concatenate([cube.triangles + number * count for number in range(3)]),
    )
    chandelier = model_of(bulbs, **black, emission=(RADIANCE,) * 3)
    snapshot = still([Thing(hollow(3.0, **black)), Thing(chandelier)], lights=())
    baked = bake(snapshot, settings=replace(COARSE, texel_m=0.05))
    points, bounced = read(baked, 1, snapshot, baked.layers[0].bounced, steps=12)
    # Neither along the row of them, where one hides another, nor in the edges of walls.
    chosen = (np.abs(points[:, 0]) < 1.0) & (np.sort(np.abs(points), axis=1)[:, 1] < 1.3)
    points = points[chosen]
    normals = -np.sign(points) * np.eye(3)[np.argmax(np.abs(points), axis=1)]
    expected = sum(cube_light(points, normals, place) for place in places)
    error = bounced[chosen][:, 0] / expected - 1.0
    assert error.mean() == pytest.approx(0.0, abs=0.02)
    assert error.std() < 0.06


def test_emitters_within_another_are_a_part_of_it() -> None:
    """The bulb of a shade is, and one at its lower edge; what hangs out farther is not."""
    shade, bulb, below, beside = (0, 0, 0, 0.2), (0, 0, -0.1, 0.04), (0, 0, -0.19, 0.04), (0.3,) * 4
    balls = np.array([bulb, shade, beside, below, (0, 0, -0.2, 0.04)], np.float32)
    np.testing.assert_array_equal(without_nested(balls), balls[[2, 1, 4]])
