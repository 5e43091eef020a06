"""What rays from polished surfaces meet, against optics: where, how bright, and at once."""

from __future__ import annotations

import itertools
from dataclasses import replace

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.native.library import load_library, using_instruction_set
from sailenv_ros.render.contract import RenderRequest
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.types.baked_light import LIGHT_TERMS, ObjectLight
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Environment, Light
from sailenv_ros.types.model import Mesh
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.support.baked import baked, chart, layer
from tests.support.picture import linear
from tests.support.tiny_scenes import (
    Thing,
    box_mesh,
    camera_at,
    mesh_of,
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


def camera(width: int = 160) -> Camera:
    """At the origin, looking at the metal."""
    return replace(camera_at(width=width, height=width * 3 // 4), picture=PLAIN)


def picture(
    native: NativeRenderer, *things: Thing, width: int = 160, lights: tuple[Light, ...] = ()
) -> NDArray[np.uint8]:
    """In a dark baked room whose far wall alone has a chart."""
    layers = [layer(light) for light in lights]
    light = baked({1: chart(BACK_WALL.model, BACK_WALL.pose)}, layers, layer(None))
    scene = snapshot_of([BACK_WALL, *things], lights=lights, environment=BLACK, baked=light)
    request = RenderRequest(scene, camera(width), ("rgb",))
    rgb: NDArray[np.uint8] = native.render(request).views["rgb"]
    return rgb


def before_black(*things: Thing) -> WorldSnapshot:
    """In a dark baked room whose far wall mirrors nothing."""
    matt = model_of(wall_mesh(8.0, 8.0), base_colour=(0.0, 0.0, 0.0, 1.0), roughness=1.0)
    back = Thing(matt, BACK_WALL.pose)
    light = baked({1: chart(back.model, back.pose)}, [], layer(None))
    return snapshot_of([back, *things], lights=(), environment=BLACK, baked=light)


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


def test_metal_mirrors_the_light_at_vertices(native: NativeRenderer) -> None:
    """A card before it whose light is three times what its terms say."""
    card = Thing(
        model_of(box_mesh((0.02, 1.2, 1.2)), base_colour=(0.5, 0.5, 0.5, 1.0), roughness=1.0),
        Pose((-1.0, 0.8, 0.3)),
    )
    terms = np.zeros((1, LIGHT_TERMS, 3), np.float32)
    terms[0, 0] = 0.2
    fitted = np.full((1, 24, 2), 0.25, np.float16)
    own = ObjectLight(
        bounced=terms,
        direct=np.zeros((1, LIGHT_TERMS), np.float32),
        axes=np.eye(3, dtype=np.float32),
        found=3 * fitted,
        fitted=fitted,
    )
    light = baked({1: chart(BACK_WALL.model, BACK_WALL.pose)}, [], layer(None))
    scene = snapshot_of([BACK_WALL, METAL, card], lights=(), environment=BLACK, baked=light)
    request = RenderRequest(replace(scene, object_light={3: own}), camera(), ("rgb",))
    seen = around(native.render(request).views["rgb"], place_of((-0.99, 0.8, 0.3)))
    np.testing.assert_allclose(seen, 3 * 0.2 * 0.5 * np.array(TINT), rtol=0.08)


def test_what_is_hidden_from_the_metal_is_not_mirrored(native: NativeRenderer) -> None:
    """A card between lamp and metal, beside the camera's view."""
    lamp = Thing(LAMP, Pose((-1.0, 0.9, 0.0)))
    free = picture(native, METAL, lamp)
    hidden = picture(native, METAL, lamp, Thing(CARD, Pose((-0.4, 0.9, 0.0))))
    seen = place_of((-0.6, 0.9, 0.0))
    assert around(free, seen).max() > 0.2
    assert around(hidden, seen).max() < 0.02


def test_a_pane_mirrors_with_both_of_its_faces(native: NativeRenderer) -> None:
    """Four hundredths each, head-on, with all that goes to and fro between them."""
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
    expected = 2.0 * 0.04 / 1.04 * np.array([9.0, 6.0, 3.0])
    np.testing.assert_allclose(around(with_lamp, seen), expected, rtol=0.1)


def test_edges_in_a_pane_are_where_optics_says(native: NativeRenderer) -> None:
    """The side of a slanted box, row by row: no steps of several pixels."""
    pane = Thing(
        model_of(
            wall_mesh(4.0, 4.0), base_colour=(1.0, 1.0, 1.0, 0.0), alpha="blend", roughness=0.05
        ),
        Pose((3.0, 0.0, 0.0)),
    )
    bright = model_of(box_mesh(1.2), base_colour=(0.0, 0.0, 0.0, 1.0), emission=(9.0, 9.0, 9.0))
    turn = 20.0
    box = Thing(bright, Pose.from_rpy_deg((-1.0, 0.7, 0.0), (turn, 0.0, 0.0)))
    light = linear(picture(native, pane, box, width=320))[..., 1]
    lens = camera(320).intrinsics
    # The right side of its front, 6.4 m of light's way off.
    rows = np.arange(lens.height)
    rows = rows[np.abs(lens.cy - rows) / lens.fy * 6.4 < 0.3]
    z = (lens.cy - rows) / lens.fy * 6.4
    y = 0.7 - (0.6 + np.sin(np.radians(turn)) * z) / np.cos(np.radians(turn))
    expected = lens.cx - lens.fx * y / 6.4
    found = np.array([np.flatnonzero(light[row] > 0.3)[-1] for row in rows])
    assert len(rows) > 10
    np.testing.assert_allclose(found + 0.5, expected, atol=1.0)


ROUGH = 0.4
ROUGH_METAL = Thing(
    model_of(box_mesh((1.0, 2.0, 2.0)), base_colour=(*TINT, 1.0), metallic=1.0, roughness=ROUGH),
    Pose((3.5, 0.0, 0.0)),
)


PANEL = Light(
    name="panel", type="area", position_m=(2.4, 0.5, 0.0), direction=(1.0, 0.0, 0.0),
    width_m=0.5, height_m=0.5, intensity=10.0,
)  # fmt: skip
PANEL_BOX = np.array((2.3999, 0.25, -0.25)), np.array((2.4001, 0.75, 0.25))
"""Two corners of its face."""


@pytest.mark.parametrize("distance_m", [0.2, 0.5])
def test_rough_metal_mirrors_what_its_lobe_meets(native: NativeRenderer, distance_m: float) -> None:
    """A lamp before it, against 200,000 rays of GGX's lobe."""
    size, centre = np.array((0.25, 0.5, 0.5)), np.array((3.0 - distance_m, 0.5, 0.0))
    lamp = model_of(box_mesh(tuple(size)), base_colour=(0.0, 0.0, 0.0, 1.0), emission=GLOW)
    rgb = picture(native, ROUGH_METAL, Thing(lamp, Pose(tuple(centre))), width=960)
    for y in (0.16, 0.2, 0.24):
        expected = lobe_share(centre - size / 2, centre + size / 2, y) * GLOW[0] * TINT[0]
        # Pixels share what they meet with those around them.
        assert 0.85 * expected < mean_at(rgb, y) < 1.2 * expected


def test_rough_metal_mirrors_the_face_of_an_area_light(native: NativeRenderer) -> None:
    """It has no body; what stands before it hides it."""
    light = replace(PANEL, intensity=0.3)
    seen = mean_at(picture(native, ROUGH_METAL, width=960, lights=(light,)), 0.2)
    assert seen == pytest.approx(lobe_share(*PANEL_BOX, 0.2) * 0.3 * TINT[0], rel=0.2)
    card = Thing(CARD, Pose((2.7, 0.8, 0.0)))  # before the panel, but not before the eye
    assert mean_at(picture(native, ROUGH_METAL, card, width=960, lights=(light,)), 0.2) < 0.01


def board(roughness: float, grey: float = 0.5) -> Thing:
    """A box of wood or plastic in the metal's place."""
    colour = (grey, grey, grey, 1.0)
    model = model_of(box_mesh((1.0, 2.0, 2.0)), base_colour=colour, roughness=roughness)
    return Thing(model, Pose((3.5, 0.0, 0.0)))


@pytest.mark.parametrize(
    ("roughness", "grey"),
    [(0.1, 0.5), (0.2, 0.5), (0.32, 0.5), (0.4, 0.5), (0.355, 0.02), (0.5, 0.5), (0.58, 0.02)],
)
def test_a_board_mirrors_the_face_of_an_area_light(
    native: NativeRenderer, roughness: float, grey: float
) -> None:
    """Four hundredths of what metal does, at its own place and no other; not what is hidden."""
    rgb = picture(native, board(roughness, grey), width=960, lights=(PANEL,))
    for y in (0.16, 0.25):
        expected = 0.04 * 10.0 * lobe_share(*PANEL_BOX, y, roughness)
        assert mean_at(rgb, y) == pytest.approx(expected, rel=0.2, abs=0.004)
    assert mean_at(rgb, -0.6) < 0.01
    card = Thing(CARD, Pose((2.7, 0.8, 0.0)))  # before the panel, but not before the eye
    dark = picture(native, board(roughness, grey), card, width=960, lights=(PANEL,))
    assert mean_at(dark, 0.25) < 0.1 * mean_at(rgb, 0.25)


def test_a_rough_board_mirrors_an_area_light_once(native: NativeRenderer) -> None:
    """By its lobe, though the light around the board has the panel's, too."""
    thing, light = board(0.55, 0.0), replace(PANEL, intensity=4.0)
    room = baked({1: chart(BACK_WALL.model, BACK_WALL.pose)}, [layer(light)], layer(None))
    scene = snapshot_of([BACK_WALL, thing], lights=(light,), environment=BLACK, baked=room)
    terms = np.zeros((2, LIGHT_TERMS), np.float32)
    # Irradiance / pi in front of the panel's middle, a patch of which sends 4 cos² / pi distance².
    steps = (np.arange(50) + 0.5) / 100.0 - 0.25
    distance2 = 0.6**2 + steps**2 + (steps[:, None] + 0.3) ** 2
    terms[0, 0] = (4.0 / np.pi * 0.6**2 / distance2**2).mean() * 0.5**2
    lit = ObjectLight(
        bounced=np.zeros((2, LIGHT_TERMS, 3), np.float32), direct=terms, axes=np.eye(3, dtype="f4")
    )
    request = RenderRequest(replace(scene, object_light={2: lit}), camera(960), ("rgb",))
    rgb = native.render(request).views["rgb"]
    expected = 0.04 * 4.0 * lobe_share(*PANEL_BOX, 0.2, 0.55)
    assert mean_at(rgb, 0.2) == pytest.approx(expected, rel=0.15)


@pytest.mark.parametrize("roughness", [0.1, 0.25, 0.4])
def test_what_mirrors_little_mirrors_what_stands_before_it(
    native: NativeRenderer, roughness: float
) -> None:
    """Of a board a few hundredths, of which pictures from the middle of the room know nothing."""
    size, centre = np.array((0.25, 0.5, 0.5)), np.array((2.0, 0.5, 0.0))
    glow = model_of(box_mesh(tuple(size)), base_colour=(0.0, 0.0, 0.0, 1.0), emission=(0.45,) * 3)
    rgb = picture(native, board(roughness), Thing(glow, Pose(tuple(centre))), width=960)
    for y in (0.25, 0.28):
        expected = 0.04 * 0.45 * lobe_share(centre - size / 2, centre + size / 2, y, roughness)
        assert mean_at(rgb, y) == pytest.approx(expected, rel=0.25)


def test_a_board_mirrors_of_a_bright_room_what_a_card_does_not_hide(native: NativeRenderer) -> None:
    """Pictures from the middle of the room know nothing of the card, which is before the board."""
    wall = Thing(BACK_WALL.model, Pose.from_rpy_deg((-2.0, 0.0, 0.0), (0.0, 0.0, 180.0)))
    light = baked({1: chart(wall.model, wall.pose)}, [], layer(None, bounced=2.0))

    def seen(*things: Thing) -> float:
        scene = snapshot_of([wall, board(0.4), *things], lights=(), environment=BLACK, baked=light)
        return mean_at(native.render(RenderRequest(scene, camera(960), ("rgb",))).views["rgb"], 0.3)

    card = Thing(CARD, Pose((2.7, 0.84, 0.0)))  # not before the eye
    of_wall = lobe_share(np.array((-2.1, -4.0, -4.0)), np.array((-2.0, 4.0, 4.0)), 0.3, 0.4)
    of_card = lobe_share(np.array((2.69, 0.24, -0.6)), np.array((2.71, 1.44, 0.6)), 0.3, 0.4)
    assert seen(card) / seen() == pytest.approx(1.0 - of_card / of_wall, abs=0.12)


def test_a_lamp_has_a_highlight_on_rough_metal(native: NativeRenderer) -> None:
    """Of a point light: distribution, masking and tint at a point that sees it, and shadow."""
    lamp = Light(name="bulb", type="point", position_m=(2.0, 0.6, 0.0), intensity=0.1)
    seen = mean_at(picture(native, ROUGH_METAL, width=960, lights=(lamp,)), 0.3)
    point = np.array((3.0, 0.3, 0.0))
    offset = np.array(lamp.position_m) - point
    towards, view = offset / np.linalg.norm(offset), -point / np.linalg.norm(point)
    halfway = (towards + view) / np.linalg.norm(towards + view)
    a2, nl, nv, nh = ROUGH**4, -towards[0], -view[0], -halfway[0]
    smith = nl * np.sqrt(nv**2 * (1 - a2) + a2) + nv * np.sqrt(nl**2 * (1 - a2) + a2)
    lobe = 0.5 * a2 / (np.pi * (1.0 - nh**2 * (1.0 - a2)) ** 2 * smith)
    expected = TINT[0] * lobe * nl * 0.1 / (offset @ offset)
    assert seen == pytest.approx(expected, rel=0.15)
    card = Thing(CARD, Pose((2.3, 0.9, 0.0)))
    assert mean_at(picture(native, ROUGH_METAL, card, width=960, lights=(lamp,)), 0.3) < 0.01


def mean_at(rgb: NDArray[np.uint8], y: float) -> float:
    """Mean red radiance of a picture 960 wide around a point of the metal's front [m]."""
    lens = camera(960).intrinsics
    column, row = round(lens.cx - lens.fx * y / 3.0), round(lens.cy)
    return float(linear(rgb)[row - 16 : row + 16, column - 2 : column + 3, 0].mean())


def lobe_share(
    low: NDArray[np.float64], high: NDArray[np.float64], y: float, roughness: float = ROUGH
) -> float:
    """Share of what a point of the rough metal sends to the origin that comes from a box.

    Walter et al. 2007, "Microfacet models for refraction through rough surfaces": D, G and (41).
    """
    random = np.random.default_rng(3)
    point, a2 = np.array((3.0, y, 0.0)), roughness**4
    u, turn = random.random(200_000), 2.0 * np.pi * random.random(200_000)
    cosine = np.sqrt((1.0 - u) / (1.0 + (a2 - 1.0) * u))
    sine = np.sqrt(1.0 - cosine**2)
    facet = np.stack([-cosine, sine * np.cos(turn), sine * np.sin(turn)], axis=1)
    view = -point / np.linalg.norm(point)
    along = facet @ view
    ray = 2.0 * along[:, None] * facet - view
    up = np.maximum(-ray[:, 0], 0.0)

    def unmasked(cosines: NDArray[np.float64] | float) -> NDArray[np.float64]:
        square = np.square(cosines)
        return np.asarray(2.0 * cosines / (cosines + np.sqrt(a2 + (1.0 - a2) * square)))

    weight = unmasked(np.maximum(up, 1e-6)) * unmasked(-view[0]) * along / (-view[0] * cosine)
    with np.errstate(divide="ignore"):
        ends = np.sort(np.stack([(low - point) / ray, (high - point) / ray]), axis=0)
    enter, leave = ends[0].max(axis=1), ends[1].min(axis=1)
    hit = (up > 0.0) & (along > 0.0) & (enter < leave) & (leave > 0.0)
    return float((weight * hit).mean())


def rod_mesh(radius_m: float, length_m: float, segments: int = 24) -> Mesh:
    """Upright and round, open at its ends."""
    turns = 2.0 * np.pi * np.arange(segments + 1) / segments
    out = np.stack([np.cos(turns), np.sin(turns), np.zeros(segments + 1)], axis=-1)
    end = np.array([0.0, 0.0, length_m / 2.0])
    first = np.arange(segments)
    above = first + segments + 1
    triangles = [[first, first + 1, above], [first + 1, above + 1, above]]
    return mesh_of(
        np.concatenate([radius_m * out - end, radius_m * out + end]),
        np.concatenate([out, out]),
        np.zeros((2 * segments + 2, 2)),
        np.concatenate([np.stack(corners, axis=-1) for corners in triangles]),
    )


@pytest.mark.parametrize("roll_deg", [0.0, 6.0])
def test_a_thin_rod_mirrors_what_stands_beside_it(native: NativeRenderer, roll_deg: float) -> None:
    """Less than two pixels wide, it shows as much of a bright wall as a cylinder does by optics."""
    radius_m, away_m, bright = 0.02, 2.95, 0.4
    look = {"base_colour": (1.0, 1.0, 1.0, 1.0), "metallic": 1.0, "roughness": 0.06}
    rod = Thing(
        model_of(rod_mesh(radius_m, 6.0), **look),
        Pose.from_rpy_deg((3.0, 0.0, 0.0), (roll_deg, 0.0, 0.0)),
    )
    wall = Thing(
        model_of(
            box_mesh((6.0, 0.1, 8.0)), base_colour=(0.0, 0.0, 0.0, 1.0), emission=(bright,) * 3
        ),
        Pose((1.0, away_m + 0.05, 0.0)),
    )
    scene = before_black(rod, wall)
    seen = replace(camera(), picture=PictureSettings(occlusion_strength=0.0, tone_curve="linear"))
    rgb = native.render(RenderRequest(scene, seen, ("rgb",))).views["rgb"]
    middle = slice(seen.intrinsics.width // 2 - 20, seen.intrinsics.width // 2 + 20)
    rows = linear(rgb)[:, middle, 1].sum(axis=1)
    # The wall reaches from 5 m before the rod to 1 m behind it: normals turned by so much show it.
    first, last = (0.5 * np.arctan2(away_m, ahead) for ahead in (5.0, -1.0))
    shown_px = radius_m * (np.sin(last) - np.sin(first)) * seen.intrinsics.fx / 3.0
    assert shown_px < 0.6
    assert rows.mean() == pytest.approx(bright * shown_px, rel=0.2)
    assert (rows > 0.25 * bright * shown_px).mean() > 0.9


def test_the_rim_of_a_cup_shows_what_stands_behind_it(native: NativeRenderer) -> None:
    """Of grey ceramics by Fresnel's law, where a quarter of its light and more is mirrored."""
    radius_m, bright = 0.2, 0.4
    look = {"base_colour": (0.5, 0.5, 0.5, 1.0), "roughness": 0.06}
    rod = Thing(model_of(rod_mesh(radius_m, 6.0, 96), **look), Pose((3.0, 0.0, 0.0)))
    glow = model_of(box_mesh((0.1, 9.0, 9.0)), base_colour=(0, 0, 0, 1), emission=(bright,) * 3)
    scene = before_black(rod, Thing(glow, Pose((5.0, 0.0, 0.0))))
    views = native.render(RenderRequest(scene, camera(640), ("rgb", "instance"))).views
    rows = (linear(views["rgb"])[..., 1] * (views["instance"] == 2)).sum(axis=1)
    # Across the rod, in radii: a normal there is turned by the angle of which this is the sine.
    across = np.linspace(0.0, 1.0, 20_001)
    fresnel = 0.04 + 0.96 * (1.0 - np.sqrt(1.0 - across**2)) ** 5
    fresnel[fresnel / (fresnel + 0.5 * (1.0 - fresnel)) < 0.25] = 0.0
    expected = 2.0 * radius_m / 3.0 * camera(640).intrinsics.fx * bright * fresnel.mean()
    assert rows.mean() == pytest.approx(expected, rel=0.2)


def post_mesh(width_m: float, edge_m: float, length_m: float) -> Mesh:
    """An upright board that faces -x, with a rounded edge on its left."""
    half, round_ = width_m / 2.0, np.sqrt(0.5)
    sides = [(0.0, -half, (-1, 0, 0)), (0.0, half, (-1, 0, 0))]
    sides.append((edge_m, half + edge_m, (-round_, round_, 0)))
    ends = [(-0.5, 0), (0.5, 1)]
    return mesh_of(
        np.array([(x, y, z * length_m) for z, _ in ends for x, y, _ in sides]),
        np.array([normal for _ in ends for *_, normal in sides]),
        np.zeros((6, 2)),
        np.array([(0, 3, 1), (1, 3, 4), (1, 4, 2), (2, 4, 5)]),
    )


@pytest.mark.parametrize(("width_m", "roll_deg"), [(0.024, 0.0), (0.018, 4.0), (0.018, 8.0)])
def test_a_narrow_post_has_no_dashes(
    native: NativeRenderer, width_m: float, roll_deg: float
) -> None:
    """Of rough metal, some pixels wide: everywhere half of its lobe meets a bright wall."""
    look = {"base_colour": (1.0, 1.0, 1.0, 1.0), "metallic": 1.0, "roughness": 0.24}
    post = Thing(
        model_of(post_mesh(width_m, 0.003, 5.0), **look),
        Pose.from_rpy_deg((3.0, 0.0, 0.0), (roll_deg, 0.0, 0.0)),
    )
    glow = model_of(box_mesh((0.1, 4.0, 9.0)), base_colour=(0, 0, 0, 1), emission=(0.4,) * 3)
    wall = Thing(glow, Pose((-1.0, 2.0, 0.0)))
    scene = before_black(post, wall)
    request = RenderRequest(scene, camera(960), ("rgb", "instance", "normals"))
    seen = native.render(request).views
    face = (seen["instance"] == 2) & (seen["normals"][..., 2] < -0.9999)
    inner = cv2.erode(face.astype(np.uint8), np.ones((1, 3))) > 0
    rows = zip(seen["rgb"], inner, strict=True)
    along = np.array([linear(rgb)[own, 1].mean() for rgb, own in rows])[40:]
    smooth = np.convolve(along, np.ones(31) / 31, "valid")
    assert np.std(along[15:-15] / smooth) < 0.15


def test_frames_do_not_depend_on_threads_or_the_instruction_set() -> None:
    """Rays are shared within rows and squares, which are the same for any number of threads."""
    things = METAL, Thing(LAMP, Pose((-1.0, 0.8, 0.3)))
    made = set()
    for name, threads in itertools.product(load_library().instruction_sets, (1, 3)):
        with using_instruction_set(name):
            renderer = NativeRenderer(threads=threads)
            made.add(picture(renderer, *things).tobytes())
            renderer.close()
    assert len(made) == 1
