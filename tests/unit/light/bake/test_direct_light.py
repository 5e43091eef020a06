"""What arrives straight from lights, against closed formulas."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sailenv_ros.light.bake.pipeline import bake
from sailenv_ros.types.baked_light import BakedLight
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Light
from tests.support.bake_scenes import COARSE, ground, read, still
from tests.support.reference_rays import glazing_transmittance
from tests.support.tiny_scenes import Thing, box_mesh, model_of

FLOOR = Thing(ground(4.0))


def direct_on_floor(
    *lights: Light, things: tuple[Thing, ...] = ()
) -> tuple[np.ndarray, np.ndarray]:
    """Points of the floor and what arrives there straight from the last light."""
    snapshot = still([FLOOR, *things], lights=lights)
    baked = bake(snapshot, settings=COARSE)
    return read(baked, 1, snapshot, baked.layers[-1].direct)


@pytest.mark.parametrize("direction", [(0.0, 0.0, -1.0), (0.6, 0.0, -0.8), (0.3, -0.9, -0.4)])
def test_the_sun_gives_its_cosine(direction: tuple[float, float, float]) -> None:
    """Irradiance / pi of a directional light of intensity 1 is cosine / pi."""
    sun = Light(name="sun", type="directional", direction=direction)
    _, direct = direct_on_floor(sun)
    np.testing.assert_allclose(direct, -sun.direction[2] / math.pi, rtol=2e-3)


def test_colour_and_intensity_are_not_baked() -> None:
    """A layer is for white light of intensity 1, whatever the light's are."""
    sun = Light(name="sun", type="directional", intensity=7.0, colour=(1.0, 0.5, 0.0))
    _, direct = direct_on_floor(sun)
    np.testing.assert_allclose(direct, 1.0 / math.pi, rtol=2e-3)


def test_a_lamp_falls_off_with_the_square_of_the_distance() -> None:
    """Irradiance is cosine / d² times the window that ends it at its range."""
    lamp = Light(name="lamp", type="point", position_m=(0.3, -0.2, 1.5), range_m=8.0)
    points, direct = direct_on_floor(lamp)
    offset = np.array(lamp.position_m) - points
    d2 = (offset**2).sum(axis=1)
    window = np.clip(1.0 - (d2 / 64.0) ** 2, 0.0, 1.0) ** 2
    expected = window * offset[:, 2] / d2**1.5 / math.pi
    np.testing.assert_allclose(direct, expected, rtol=0.02)


def test_a_spot_light_ends_at_its_cone() -> None:
    """All of it within the inner cone, nothing beyond the outer."""
    spot = Light(
        name="spot", type="spot", position_m=(0.0, 0.0, 2.0), inner_cone_deg=20, outer_cone_deg=30
    )
    points, direct = direct_on_floor(spot)
    radius = np.hypot(points[:, 0], points[:, 1])
    angle = np.degrees(np.arctan(radius / 2.0))
    assert (direct[angle > 34] == 0).all()
    full = angle < 17
    expected = 2.0 / (radius[full] ** 2 + 4.0) ** 1.5 / math.pi
    np.testing.assert_allclose(direct[full], expected, rtol=0.02)


def test_an_area_light_gives_its_form_factor() -> None:
    """Irradiance / pi of radiance 1 is the form factor of the rectangle (parallel plates)."""
    width, height, above = 1.2, 0.8, 1.0
    panel = Light(
        name="panel", type="area", position_m=(0, 0, above), width_m=width, height_m=height
    )
    points, direct = direct_on_floor(panel)

    def corner(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        a, b = np.sqrt(1 + x * x), np.sqrt(1 + y * y)
        return (x / a * np.arctan(y / a) + y / b * np.arctan(x / b)) / (2 * math.pi)

    # The width of a light that shines straight down lies along y.
    x0, x1 = (-height / 2 - points[:, 0]) / above, (height / 2 - points[:, 0]) / above
    y0, y1 = (-width / 2 - points[:, 1]) / above, (width / 2 - points[:, 1]) / above
    expected = corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0)
    np.testing.assert_allclose(direct, expected, rtol=0.03, atol=1e-3)


def test_an_area_light_shines_to_its_front_alone() -> None:
    """Nothing arrives behind it."""
    panel = Light(name="panel", type="area", position_m=(0, 0, 1), direction=(0, 0, 1))
    _, direct = direct_on_floor(panel)
    assert (direct == 0).all()


def test_what_stands_in_the_way_casts_a_shadow() -> None:
    """No sun under a board, all of it beside the board; the visibility map tells the same."""
    sun = Light(name="sun", type="directional")
    board = Thing(model_of(box_mesh((1.0, 1.0, 0.1))), Pose((0.0, 0.0, 0.5)))
    snapshot = still([FLOOR, board], lights=(sun,))
    baked = bake(snapshot, settings=COARSE)
    points, direct = read(baked, 1, snapshot, baked.layers[1].direct)
    visibility = baked.layers[1].visibility
    assert visibility is not None
    _, seen = read(baked, 1, snapshot, visibility)
    far = np.abs(points[:, :2]).max(axis=1)
    assert (direct[far < 0.35] == 0).all()
    # One step is left where blocks are to be looked for.
    assert (seen[far < 0.35] <= 1).all()
    np.testing.assert_allclose(direct[far > 0.65], 1 / math.pi, rtol=2e-3)
    assert (seen[far > 0.65] >= 254).all()


def test_a_shadow_ends_as_sharply_as_the_sun_is_large() -> None:
    """At points of blocks: the share of a disc of 0.53 degrees that an edge above leaves."""
    sun = Light(name="sun", type="directional")
    above = 20.0
    board = Thing(model_of(box_mesh((30.0, 30.0, 0.1))), Pose((15.0, 0.0, above)))
    snapshot = still([FLOOR, board], lights=(sun,))
    baked = bake(snapshot, settings=COARSE)
    layer = baked.layers[1]
    assert layer.edges is not None
    assert layer.visibility is not None
    index, blocks = layer.edges.index, layer.edges.blocks
    rows, columns = np.nonzero(index >= 0)
    assert ((layer.visibility[rows, columns] > 0) & (layer.visibility[rows, columns] < 255)).all()
    side = len(index)
    corners, places = _floor_places(baked, side)
    step = (np.arange(4) + 0.5) / 4.0
    down, right = np.meshgrid(step, step, indexing="ij")
    at = np.stack([columns[:, None, None] + right, rows[:, None, None] + down], axis=-1)
    # The second corner of the triangle is the right angle.
    sides = np.stack([places[0] - places[1], places[2] - places[1]], axis=1)
    along = np.linalg.solve(sides, (at.reshape(-1, 2) - places[1]).T)
    x = corners[1, 0] + along.T @ (corners[[0, 2], 0] - corners[1, 0])
    radius = math.tan(math.radians(0.265)) * (above - 0.05)
    t = np.clip(-x / radius, -1.0, 1.0)
    expected = (np.arccos(-t) + t * np.sqrt(1.0 - t * t)) / math.pi
    got = blocks[index[rows, columns], 1:5, 1:5].reshape(-1) / 255.0
    inside = (along.min(axis=0) > 0.0) & (along.max(axis=0) < 1.0)
    np.testing.assert_allclose(got[inside], expected[inside], atol=2.5 / 16)  # rays
    partial = (expected > 0.05) & (expected < 0.95) & inside
    assert partial.sum() > 50
    assert np.abs(got - expected)[partial].mean() < 1 / 16


def _floor_places(baked: BakedLight, side: int) -> tuple[np.ndarray, np.ndarray]:
    """Corners of one of the floor's triangles, in the world and in the map [texels]."""
    chart = baked.charts[1]
    flat, mesh = chart.unwrapping, FLOOR.model.parts[0].mesh
    triangle = flat.triangles[0][0]
    uvs = flat.uvs[0][triangle] * np.asarray(chart.scale) + np.asarray(chart.offset)
    return mesh.positions[flat.vertices[0][triangle]].astype(float), uvs * side


def test_double_glazing_mirrors_what_the_equations_say() -> None:
    """Four faces of 4 % head-on, with what goes to and fro; nothing passes along the pane."""
    sheet = (1.0 - 0.04) / (1.0 + 0.04)
    assert glazing_transmittance(np.float32([1.0, 0.0])) == pytest.approx([sheet**2, 0.0], abs=1e-6)
    # At Brewster's angle one polarisation is not mirrored at all, the other by cos²(2 angle).
    brewster = math.atan(1.5)
    mirrored = 0.5 * math.cos(2 * brewster) ** 2
    sheet = (1.0 - mirrored) / (1.0 + mirrored)
    assert glazing_transmittance(np.float32([math.cos(brewster)])) == pytest.approx(
        [sheet**2], abs=1e-5
    )


@pytest.mark.parametrize(("alpha", "share"), [("blend", 0.75), ("opaque", 0.0)])
def test_glass_lets_light_pass(alpha: str, share: float) -> None:
    """The sun shines through a pane, less its alpha and what it mirrors; not through a board."""
    clear = {"alpha": alpha, "double_sided": True, "base_colour": (1.0, 1.0, 1.0, 0.25)}
    pane = Thing(model_of(box_mesh((0.01, 9.0, 9.0)), **clear), Pose((2.5, 0.0, 0.0)))
    sun = Light(name="sun", type="directional", direction=(-1.0, 0.0, -1.0))
    points, direct = direct_on_floor(sun, things=(pane,))
    behind = points[:, 0] < 1.9
    cosine = math.sqrt(0.5)
    share *= float(glazing_transmittance(np.float32([cosine]))[0])
    np.testing.assert_allclose(direct[behind], share * cosine / math.pi, atol=2e-3)


def test_layers_come_in_the_order_of_the_lights() -> None:
    """The surroundings first; only directional lights have a visibility map."""
    lights = (
        Light(name="lamp", type="point"),
        Light(name="sun", type="directional"),
        Light(name="panel", type="area"),
    )
    baked = bake(still([FLOOR], lights=lights), settings=COARSE)
    assert [layer.light for layer in baked.layers] == [None, *lights]
    assert [layer.visibility is not None for layer in baked.layers] == [False, False, True, False]
    assert not baked.layers[0].direct.any()
