"""Pictures under baked light, against the light that was put into the map."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.rays.self_occlusion import arriving_share
from sailenv_ros.render.contract import RenderBackend, RenderRequest
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.types.baked_light import LIGHT_TERMS, ObjectLight, SunEdges
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Environment, Light
from sailenv_ros.types.model import Model
from sailenv_ros.types.snapshot import WorldSnapshot
from sailenv_ros.types.views import LIT_VIEWS, RENDERED_VIEWS
from tests.render.conftest import Render
from tests.support.baked import SIZE, baked, chart, layer
from tests.support.curved_meshes import bowl
from tests.support.picture import linear
from tests.support.tiny_scenes import (
    FORWARD,
    Thing,
    box_mesh,
    camera_at,
    model_of,
    snapshot_of,
    wall_mesh,
)

AHEAD = Pose((3.0, 0.0, 0.0))
WALL = model_of(wall_mesh(8.0, 8.0), base_colour=(0.5, 0.4, 0.3, 1.0), roughness=1.0)
ALBEDO = np.array([0.5, 0.4, 0.3])
DARK = Environment(sky_zenith=(0, 0, 0), sky_horizon=(0, 0, 0), sky_ground=(0, 0, 0))
SUN = Light(name="sun", type="directional", direction=(1.0, 0.0, 0.0), intensity=1.5)

pytestmark = pytest.mark.gl


def test_a_matt_surface_shows_albedo_times_the_map(render: Render) -> None:
    """Radiance is albedo times irradiance / pi, read at the surface's own place."""
    # In the map u runs to the right: a ramp from left to right.
    ramp = np.linspace(0.0, 1.0, SIZE)[None, :, None]
    light = baked({1: chart(WALL, AHEAD)}, [], layer(None, bounced=ramp * np.ones(3)))
    scene = snapshot_of([Thing(WALL, AHEAD)], lights=(), environment=DARK, baked=light)
    camera = camera_at()
    got = linear(render(scene, camera, "rgb")["rgb"]).mean(axis=0)
    columns = np.arange(camera.intrinsics.width)
    y = -(columns - camera.intrinsics.cx) / camera.intrinsics.fx * 3.0
    u = 4 / SIZE + (0.5 - y / 8.0) * (SIZE - 8) / SIZE
    expected = np.clip(u * SIZE - 0.5, 0, SIZE - 1) / (SIZE - 1)
    np.testing.assert_allclose(got, expected[:, None] * ALBEDO, rtol=0.05, atol=0.003)


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_the_main_light_arrives_as_far_as_the_map_says(render: Render, share: float) -> None:
    """Its irradiance times albedo / pi times the share that is not in shadow."""
    matt = model_of(wall_mesh(8.0, 8.0), base_colour=(0.5, 0.4, 0.3, 1.0), roughness=1.0)
    light = baked({1: chart(matt, AHEAD)}, [layer(SUN, visible=share)])
    scene = snapshot_of([Thing(matt, AHEAD)], lights=(SUN,), environment=DARK, baked=light)
    got = linear(render(scene, camera_at(), "rgb")["rgb"]).mean(axis=(0, 1))
    # Beside the matt part a little is reflected by the surface itself, hardly any at roughness 1.
    np.testing.assert_allclose(got, share * 1.5 * ALBEDO / np.pi, rtol=0.08, atol=0.004)


def test_where_a_shadow_ends_blocks_tell_the_share(render: Render) -> None:
    """Bilinear between the points of a texel's block; a texel without one has the map's share."""
    points = 0.25 + 0.5 * (np.arange(6) - 0.5) / 4.0  # a ramp along u within each texel
    blocks = np.broadcast_to(np.rint(255.0 * points), (1, 6, 6)).astype(np.uint8)
    index = np.zeros((SIZE, SIZE), np.int32)
    index[: SIZE // 2] = -1
    sun = replace(layer(SUN, visible=0.5), edges=SunEdges(index=index, blocks=blocks.copy()))
    light = baked({1: chart(WALL, AHEAD)}, [sun])
    scene = snapshot_of([Thing(WALL, AHEAD)], lights=(SUN,), environment=DARK, baked=light)
    camera = camera_at()
    got = linear(render(scene, camera, "rgb")["rgb"]) / (1.5 * ALBEDO / np.pi)
    height, width = got.shape[:2]
    columns = np.arange(width)
    y = -(columns - camera.intrinsics.cx) / camera.intrinsics.fx * 3.0
    within = (4 + (0.5 - y / 8.0) * (SIZE - 8)) % 1.0
    inside = (within > 0.1) & (within < 0.9)
    halves = got[: height // 2 - 8], got[height // 2 + 8 :]
    # Which half of the map is above is the chart's matter.
    flat, ramp = sorted((half.mean(axis=(0, 2)) for half in halves), key=lambda h: np.ptp(h))
    np.testing.assert_allclose(flat, 0.5, rtol=0.08)
    np.testing.assert_allclose(ramp[inside], (0.25 + 0.5 * within)[inside], rtol=0.08, atol=0.01)
    assert inside.sum() > 20


def test_shadows_of_what_moves_begin_where_it_stands(render: Render) -> None:
    """On what is baked the edge lies where rays from the sun pass, within a texel of the map."""
    sun = replace(SUN, direction=(1.0, 3.0, 0.0))
    board = model_of(box_mesh((0.002, 2.5, 3.0)), roughness=1.0)
    light = baked({1: chart(WALL, AHEAD)}, [layer(sun, visible=1.0)])
    things = [Thing(WALL, AHEAD), Thing(board, Pose((2.901, -1.75, 0.0)))]
    scene = snapshot_of(things, lights=(sun,), environment=DARK, baked=light)
    camera = camera_at()
    got = linear(render(scene, camera, "rgb")["rgb"])[camera.intrinsics.height // 2, :, 0]
    y = -(np.arange(len(got)) - camera.intrinsics.cx) / camera.intrinsics.fx * 3.0
    beside = (y > -0.5) & (y < 0.3)  # the board hides what lies farther
    y, share = y[beside][::-1], got[beside][::-1] / got[beside].max()
    assert share[0] < 0.05
    # The board's edge lies at -0.5 m, a tenth of a metre before the wall.
    assert np.interp(0.5, share, y) == pytest.approx(-0.5 + 0.1 * 3.0, abs=0.03)


def test_what_moves_is_lit_from_the_probes(render: Render) -> None:
    """A surface without a chart has c0 + c . n, each colour with its own four numbers."""
    probes = np.zeros((4, 3))
    probes[0] = 0.5, 0.25, 0.125
    probes[1] = -0.25, 0.0, 0.125  # along x: the wall's normal is -x
    light = baked({}, [], layer(None, probe_bounced=probes))
    scene = snapshot_of([Thing(WALL, AHEAD)], lights=(), environment=DARK, baked=light)
    got = linear(render(scene, camera_at(), "rgb")["rgb"]).mean(axis=(0, 1))
    np.testing.assert_allclose(got, ALBEDO * [0.75, 0.25, 0.0], rtol=0.04, atol=0.004)


def test_each_side_of_what_can_move_is_lit_by_its_own_place(render: Render) -> None:
    """Sides count by the squares of the normal along the body's axes; each has its own slopes."""
    turn = np.radians(30.0)
    axes = np.array([[np.cos(turn), np.sin(turn), 0], [-np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    terms = np.zeros((1, LIGHT_TERMS, 3), np.float32)
    terms[0, 0] = 0.1
    terms[0, 1] = -0.1, 0.0, 0.1  # along the normal, -x
    terms[0, 16:20] = np.outer([0.4, 0.0, 0.1, 0.2], [1.0, 0.5, 0.0])  # of the side -x
    terms[0, 8:12, 2] = 0.8, 0.0, -0.1, 0.0  # of the side +y
    terms[0, 4:8] = terms[0, 20:28] = 9.0  # of sides that are turned away
    own = ObjectLight(
        bounced=terms, direct=np.zeros((1, LIGHT_TERMS), np.float32), axes=axes.astype(np.float32)
    )
    scene = unmapped(WALL, AHEAD)
    camera = camera_at()
    got = linear(render(replace(scene, object_light={1: own}), camera, "rgb")["rgb"])
    k = camera.intrinsics
    y = -(np.arange(k.width) - k.cx)[None, :] / k.fx * 3.0
    z = -(np.arange(k.height) - k.cy)[:, None] / k.fy * 3.0
    front = np.cos(turn) ** 2 * (0.4 + 0.1 * y + 0.2 * z)
    left = np.sin(turn) ** 2 * (0.8 - 0.1 * y + 0.0 * z)
    wanted = np.stack([0.2 + front, 0.1 + 0.5 * front, left], axis=-1)
    np.testing.assert_allclose(got, np.maximum(wanted, 0.0) * ALBEDO, rtol=0.05, atol=0.004)


def even_light(radiance: float) -> ObjectLight:
    """Irradiance / pi that is the same everywhere."""
    terms = np.zeros((1, LIGHT_TERMS, 3), np.float32)
    terms[0, 0] = radiance
    even = np.zeros((1, LIGHT_TERMS), np.float32)
    return ObjectLight(bounced=terms, direct=even, axes=np.eye(3, dtype=np.float32))


def unmapped(model: Model, pose: Pose) -> WorldSnapshot:
    """A dark baked room in which one thing stands that has no chart."""
    room = baked({}, [], layer(None))
    return snapshot_of([Thing(model, pose)], lights=(), environment=DARK, baked=room)


def test_where_an_object_hides_itself_less_light_arrives(render: Render) -> None:
    """In half a sphere a half does; between its parts light goes to and fro."""
    inside = model_of(bowl(), base_colour=(0.5, 0.4, 0.3, 1.0), roughness=1.0)
    scene = unmapped(inside, Pose.from_rpy_deg((3.0, 0.0, 0.0), (0.0, -90.0, 0.0)))
    light = {1: even_light(0.8)}
    got = linear(render(replace(scene, object_light=light), camera_at(), "rgb")["rgb"])
    height, width = got.shape[:2]
    seen = got[height // 3 : -height // 3, width // 3 : -width // 3].mean(axis=(0, 1))
    share = arriving_share(np.full(3, 0.5), ALBEDO)
    # An endless number of bounces between parts that see half of each other: 0.5 / (1 - 0.5 a).
    np.testing.assert_allclose(share, 0.5 / (1.0 - 0.5 * ALBEDO), rtol=0.08)
    np.testing.assert_allclose(seen, 0.8 * share * ALBEDO, rtol=0.05, atol=0.004)


def with_factors(base: ObjectLight, factors: NDArray[np.float64]) -> ObjectLight:
    """The same light, of which rays found so many times as much at vertices as terms say."""
    fitted = np.full((1, len(factors), 2), 0.25)
    found = fitted * factors[:, None]
    return replace(base, found=found.astype(np.float16), fitted=fitted.astype(np.float16))


@pytest.mark.parametrize("alpha", ["opaque", "blend"])
def test_between_vertices_light_is_as_far_from_the_terms_as_at_them(
    render: Render, alpha: Literal["opaque", "blend"]
) -> None:
    """Of the second part of a model, behind another instance that has factors as well."""
    colour = (0.5, 0.4, 0.3, 0.5 if alpha == "blend" else 1.0)
    wall = model_of(wall_mesh(8.0, 8.0), base_colour=colour, roughness=1.0, alpha=alpha)
    model = Model(name="two", parts=model_of(box_mesh(0.01)).parts + wall.parts)
    factors = np.concatenate([np.full(24, 3.0), [0.5, 1.5, 1.5, 0.5]])
    things = [Thing(model_of(box_mesh(0.01)), Pose((3.0, 3.0, 0.0))), Thing(model, AHEAD)]
    scene = snapshot_of(things, lights=(), environment=DARK, baked=baked({}, [], layer(None)))
    light = {
        1: with_factors(even_light(0.4), np.full(24, 2.0)),
        2: with_factors(even_light(0.4), factors),
    }
    camera = camera_at()
    got = linear(render(replace(scene, object_light=light), camera, "rgb")["rgb"])[:20].mean(axis=0)
    y = -(np.arange(len(got)) - camera.intrinsics.cx) / camera.intrinsics.fx * 3.0
    wanted = 0.4 * (1.0 - y / 8.0)[:, None] * ALBEDO * colour[3]
    np.testing.assert_allclose(got, wanted, rtol=0.05, atol=0.003)


def test_light_at_vertices_is_that_of_the_front(render: Render) -> None:
    """A sheet is seen from behind; of that side nothing was found."""
    sheet = model_of(
        wall_mesh(8.0, 8.0), base_colour=(0.5, 0.4, 0.3, 1.0), roughness=1.0, double_sided=True
    )
    scene = unmapped(sheet, Pose.from_rpy_deg((3.0, 0.0, 0.0), (0.0, 0.0, 180.0)))
    light = {1: with_factors(even_light(0.4), np.full(4, 2.0))}
    got = linear(render(replace(scene, object_light=light), camera_at(), "rgb")["rgb"])
    np.testing.assert_allclose(got.mean(axis=(0, 1)), 0.4 * ALBEDO, rtol=0.04, atol=0.003)


def test_ambient_light_is_the_same_at_vertices(render: Render) -> None:
    """It was raised since the bake, and nothing else shines."""
    light = replace(baked({}, [], layer(None)), environment=DARK)
    red, green, blue = DARK.ambient
    raised = replace(DARK, ambient=(red + 0.2, green + 0.2, blue + 0.2))
    scene = snapshot_of([Thing(WALL, AHEAD)], lights=(), environment=raised, baked=light)
    dark = np.zeros((1, 4, 2), np.float16)
    own = {1: replace(even_light(0.0), found=dark, fitted=dark)}
    got = linear(render(replace(scene, object_light=own), camera_at(), "rgb")["rgb"])
    np.testing.assert_allclose(got.mean(axis=(0, 1)), 0.2 * ALBEDO, rtol=0.04, atol=0.003)


def test_light_of_a_model_that_is_gone_is_not_taken_for_the_next_ones(render: Render) -> None:
    """It has another number of vertices: what was found at them says nothing."""
    scene = unmapped(WALL, AHEAD)
    light = {1: with_factors(even_light(0.4), np.full(24, 2.0))}
    got = linear(render(replace(scene, object_light=light), camera_at(), "rgb")["rgb"])
    np.testing.assert_allclose(got.mean(axis=(0, 1)), 0.4 * ALBEDO, rtol=0.04, atol=0.003)


def test_what_was_moved_leaves_its_light_behind(render: Render) -> None:
    """An instance that does not stand where it was baked is lit from the probes."""
    surroundings = layer(None, bounced=0.8, probe_bounced=np.array([[0.2] * 3] + [[0.0] * 3] * 3))
    light = baked({1: chart(WALL, Pose((3.0, 0.0, 0.01)))}, [], surroundings)
    scene = snapshot_of([Thing(WALL, AHEAD)], lights=(), environment=DARK, baked=light)
    got = linear(render(scene, camera_at(), "rgb")["rgb"]).mean(axis=(0, 1))
    np.testing.assert_allclose(got, 0.2 * ALBEDO, rtol=0.04, atol=0.003)


def test_what_moves_casts_on_what_stands_still(render: Render) -> None:
    """A box between sun and wall: its shadow lies on the wall, where the map says all is lit."""
    box = model_of(box_mesh(0.5))
    light = baked({1: chart(WALL, AHEAD)}, [layer(SUN, visible=1.0)])
    slanted = replace(SUN, direction=(1.0, 0.5, 0.0))
    light = baked({1: chart(WALL, AHEAD)}, [layer(slanted, visible=1.0)])

    def picture(box_x: float) -> np.ndarray:  # type: ignore[type-arg]
        things = [Thing(WALL, AHEAD), Thing(box, Pose((box_x, -0.5, 0.0)))]
        scene = snapshot_of(things, lights=(slanted,), environment=DARK, baked=light)
        return linear(render(scene, camera_at(), "rgb")["rgb"])

    camera = camera_at()
    # The ray of the sun through the box's middle at x = 2 meets the wall at y = -0.5 + 0.5.
    at = round(camera.intrinsics.cx), round(camera.intrinsics.cy)
    assert picture(2.0)[at[1], at[0]].max() < 0.01
    assert picture(-3.0)[at[1], at[0]].min() > 0.05


def test_a_mirror_shows_the_room(render: Render) -> None:
    """A smooth metal wall ahead shows what stands behind the camera, in its baked light."""
    mirror = model_of(wall_mesh(8.0, 8.0), base_colour=(1, 1, 1, 1), metallic=1.0, roughness=0.0)
    back = Pose.from_rpy_deg((-4.0, 0.0, 0.0), (0.0, 0.0, 180.0))
    glowing = model_of(wall_mesh(40.0, 40.0), base_colour=(0.5, 0.4, 0.3, 1.0), roughness=1.0)
    light = baked({1: chart(mirror, AHEAD), 2: chart(glowing, back)}, [], layer(None, bounced=0.8))
    things = [Thing(mirror, AHEAD), Thing(glowing, back)]
    scene = snapshot_of(things, lights=(), environment=DARK, baked=light)
    got = linear(render(scene, camera_at(), "rgb")["rgb"])
    middle = got[got.shape[0] // 2, got.shape[1] // 2]
    np.testing.assert_allclose(middle, 0.8 * ALBEDO, rtol=0.1)


def test_polished_metal_mirrors_what_is_where_it_stands(render: Render) -> None:
    """A metal block behind a red screen shows the screen, not the green wall behind it."""
    metal = model_of(
        box_mesh((0.3, 0.3, 0.3)), base_colour=(1, 1, 1, 1), metallic=1.0, roughness=0.0
    )
    # Screens have no back: from the room's middle, and from the eye, nothing is seen of this one.
    red = model_of(wall_mesh(0.9, 0.9), base_colour=(0.6, 0.1, 0.1, 1.0), roughness=1.0)
    green = model_of(wall_mesh(40.0, 40.0), base_colour=(0.1, 0.6, 0.1, 1.0), roughness=1.0)
    poses = [Pose((3.5, 0.0, 0.0))] + [
        Pose.from_rpy_deg((x, 0.0, 0.0), (0.0, 0.0, 180.0)) for x in (2.9, -4.0)
    ]
    room = layer(None, bounced=0.8, probe_bounced=np.array([[0.8] * 3] + [[0.0] * 3] * 3))
    light = baked({2: chart(red, poses[1]), 3: chart(green, poses[2])}, [], room)
    things = [Thing(model, pose) for model, pose in zip((metal, red, green), poses, strict=True)]
    scene = snapshot_of(things, lights=(), environment=DARK, baked=light)
    got = linear(render(scene, camera_at(), "rgb")["rgb"])
    middle = got[got.shape[0] // 2, got.shape[1] // 2]
    np.testing.assert_allclose(middle, 0.8 * np.array([0.6, 0.1, 0.1]), rtol=0.1, atol=0.04)


def test_where_less_light_arrives_less_of_the_room_is_mirrored(
    render: Render, renderer: RenderBackend
) -> None:
    """In proportion to the light of the room's middle; where more arrives, the room as it is.

    That is so of pictures of the room. What rays meet is seen as it is, whatever arrives.
    """
    # As thick as this it is no flat mirror, which would show what stands before it.
    mirror = model_of(
        box_mesh((0.5, 8.0, 8.0)), base_colour=(1, 1, 1, 1), metallic=1.0, roughness=0.0
    )
    back = Pose.from_rpy_deg((-4.0, 0.0, 0.0), (0.0, 0.0, 180.0))
    glowing = model_of(wall_mesh(40.0, 40.0), base_colour=(0.5, 0.4, 0.3, 1.0), roughness=1.0)
    things = [Thing(mirror, AHEAD), Thing(glowing, back)]

    def seen(around: float) -> np.ndarray:
        # The mirror has no chart: it is lit from the probes.
        mean = np.zeros((4, 3))
        mean[0] = around
        room = layer(None, bounced=0.8, probe_bounced=mean)
        light = baked({2: chart(glowing, back)}, [], room)
        scene = snapshot_of(things, lights=(), environment=DARK, baked=light)
        got = linear(render(scene, camera_at(), "rgb")["rgb"])
        return got[got.shape[0] // 2, got.shape[1] // 2]

    np.testing.assert_allclose(seen(0.5), 0.8 * ALBEDO, rtol=0.1)
    np.testing.assert_allclose(seen(0.4), seen(0.5), rtol=0.03)
    if isinstance(renderer, NativeRenderer):
        np.testing.assert_allclose(seen(0.04), seen(0.5), rtol=0.06)
        return
    # The wall fills the half space before the mirror, and a part of what is amidst the probes sees.
    dim, dimmer = seen(0.08), seen(0.04)
    assert (dim < 0.8 * seen(0.5)).all()
    np.testing.assert_allclose(dimmer, 0.5 * dim, rtol=0.1)


def test_behind_glass_what_moves_gets_less_of_the_main_light(render: Render) -> None:
    """The share that the bake found, as what stands still has it in its map."""

    def seen(clear: float) -> np.ndarray:
        light = baked({}, [replace(layer(SUN, visible=1.0), clear=clear)])
        scene = snapshot_of([Thing(WALL, AHEAD)], lights=(SUN,), environment=DARK, baked=light)
        return linear(render(scene, camera_at(), "rgb")["rgb"])[36, 48]

    assert seen(1.0).min() > 0.05
    np.testing.assert_allclose(seen(0.5), 0.5 * seen(1.0), rtol=0.03)


def test_a_change_of_lights_leaves_nothing_behind() -> None:
    """After it a picture has the bytes that a renderer makes which has seen nothing else."""
    lamp = Light(name="lamp", type="point", position_m=(1, 1, 1), intensity=2.0)
    shiny = model_of(wall_mesh(8.0, 8.0), base_colour=(0.9, 0.9, 0.9, 1.0), roughness=0.1)
    ramp = np.linspace(0.0, 0.4, SIZE)[None, :, None] * np.ones(3)
    layers = [layer(SUN, bounced=ramp, visible=0.5), layer(lamp, direct=0.3, bounced=0.1)]
    light = baked({1: chart(shiny, AHEAD)}, layers, layer(None, bounced=0.05))
    things = [Thing(shiny, AHEAD), Thing(model_of(box_mesh(0.5)), Pose((2.0, 0.5, 0.0)))]
    moved = replace(lamp, position_m=(2.0, 0.0, 1.0))
    red = replace(SUN, colour=(1.0, 0.2, 0.1), intensity=3.0)
    kept = NativeRenderer(threads=2)
    for lights in ((SUN, lamp), (red, lamp), (red, moved), (replace(lamp, intensity=0.0), SUN)):
        scene = snapshot_of(things, lights=lights, environment=DARK, baked=light)
        fresh = NativeRenderer(threads=1)
        pictures = [
            made.render(RenderRequest(scene, camera_at(), ["rgb"])).views["rgb"]
            for made in (kept, fresh)
        ]
        fresh.close()
        np.testing.assert_array_equal(*pictures)
    kept.close()


def test_ground_truth_does_not_know_of_baked_light(render: Render) -> None:
    """Every other view is the same, to the byte, with and without it."""
    views = [view for view in RENDERED_VIEWS if view not in LIT_VIEWS]
    box = model_of(box_mesh(0.5))
    things = [Thing(WALL, AHEAD), Thing(box, Pose((2.0, 0.3, 0.1)))]
    light = baked({1: chart(WALL, AHEAD)}, [layer(SUN, visible=1.0)])
    found = []
    for bake in (None, light):
        scene = snapshot_of(things, lights=(SUN,), environment=DARK, baked=bake)
        found.append(render(scene, camera_at(), "rgb", *views, past=(scene, camera_at(FORWARD))))
    for view in views:
        assert found[0][view].tobytes() == found[1][view].tobytes(), view


@pytest.mark.parametrize(("turn_deg", "seen"), [(-20.0, 0), (20.0, 2)])
def test_metal_mirrors_what_lies_where_it_looks(render: Render, turn_deg: float, seen: int) -> None:
    """Turned down it shows the red floor aside of where the room is seen from, up the ceiling."""
    floor = model_of(box_mesh((10.0, 10.0, 0.2)), base_colour=(0.8, 0.0, 0.0, 1.0), roughness=1.0)
    ceiling = model_of(box_mesh((10.0, 10.0, 0.2)), base_colour=(0.0, 0.0, 0.8, 1.0), roughness=1.0)
    metal = model_of(wall_mesh(2.0, 2.0), metallic=1.0, roughness=0.25)
    below, above = Pose((0.0, 0.0, -5.0)), Pose((0.0, 0.0, 5.0))
    even = layer(None, bounced=1.0, probe_bounced=np.array([1.0, 0.0, 0.0, 0.0])[:, None])
    light = baked({1: chart(floor, below), 2: chart(ceiling, above)}, [], even)
    turned = Pose.from_rpy_deg((3.0, 0.0, 0.0), (0.0, turn_deg, 0.0))
    scene = snapshot_of(
        [Thing(floor, below), Thing(ceiling, above), Thing(metal, turned)],
        lights=(),
        environment=DARK,
        baked=light,
    )
    camera = camera_at()
    height, width = camera.intrinsics.height, camera.intrinsics.width
    got = linear(render(scene, camera, "rgb")["rgb"])[height // 2, width // 2]
    assert got[seen] > 0.3
    assert got[2 - seen] < 0.25 * got[seen]


@pytest.mark.parametrize(("where", "expected"), [("before", 0.5), ("hidden", 0.0), ("large", 0.0)])
def test_polished_metal_mirrors_an_area_light(render: Render, where: str, expected: float) -> None:
    """With the radiance that the light has; not behind a screen, nor in what is large."""
    panel = Light(
        name="panel", type="area", position_m=(-4.0, 0.0, 0.0), direction=(1.0, 0.0, 0.0),
        width_m=3.0, height_m=3.0, intensity=0.5,
    )  # fmt: skip
    size = 8.0 if where == "large" else 0.4
    metal = model_of(
        box_mesh((0.3, size, size)), base_colour=(1, 1, 1, 1), metallic=1.0, roughness=0.0
    )
    # Screens have no back: the eye looks through it.
    screen = model_of(wall_mesh(9.0, 9.0), base_colour=(0.5, 0.5, 0.5, 1.0), roughness=1.0)
    behind = Pose.from_rpy_deg((-3.0, 0.0, 0.0), (0.0, 0.0, 180.0))
    things = [Thing(metal, Pose((3.5, 0.0, 0.0)))]
    charts = {}
    if where == "hidden":
        things.append(Thing(screen, behind))
        charts[2] = chart(screen, behind)
    # So much light is everywhere that all of it is mirrored.
    light = layer(panel, probe_direct=np.array([[1.0] * 3] + [[0.0] * 3] * 3))
    scene = snapshot_of(things, lights=(panel,), environment=DARK, baked=baked(charts, [light]))
    got = linear(render(scene, camera_at(), "rgb")["rgb"])
    middle = got[got.shape[0] // 2, got.shape[1] // 2]
    np.testing.assert_allclose(middle, expected, rtol=0.05, atol=0.02)


@pytest.mark.parametrize("size", [0.4, 8.0])
def test_polished_metal_mirrors_a_lamp_that_glows(render: Render, size: float) -> None:
    """As its shade is seen: glow times colour times intensity, but in what is large."""
    shade = model_of(
        box_mesh((0.2, 6.0, 6.0)), base_colour=(0.5, 0.5, 0.5, 1.0), glow=(2.0, 1.0, 4.0)
    )
    metal = model_of(
        box_mesh((0.3, size, size)), base_colour=(1, 1, 1, 1), metallic=1.0, roughness=0.0
    )
    lamp = Light(name="lamp", type="point", position_m=(-4.5, 0.0, 0.0), colour=(0.1, 0.2, 0.1))
    behind = Pose((-4.0, 0.0, 0.0))
    things = [Thing(metal, Pose((3.5, 0.0, 0.0))), Thing(shade, behind, lit_by=("lamp",))]
    even = layer(None, probe_bounced=np.array([[0.5] * 3] + [[0.0] * 3] * 3))
    light = baked({2: chart(shade, behind)}, [layer(lamp)], even)
    for intensity in (1.0, 2.0, 0.0):
        lit = (replace(lamp, intensity=intensity),)
        scene = snapshot_of(things, lights=lit, environment=DARK, baked=light)
        got = linear(render(scene, camera_at(), "rgb")["rgb"])
        middle = got[got.shape[0] // 2, got.shape[1] // 2]
        np.testing.assert_allclose(
            middle, intensity * np.array([0.2, 0.2, 0.4]), rtol=0.05, atol=0.02
        )
