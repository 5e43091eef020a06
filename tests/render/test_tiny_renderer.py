"""The fallback against rays, arithmetic and the OpenGL renderer: one ground truth, two makers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.backends.tiny_renderer import TinyRenderer
from sailenv_ros.errors import InvalidRequest, RenderError
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.geometry import Pose, look_at
from sailenv_ros.types.lights import Environment
from sailenv_ros.types.snapshot import Observation, WorldSnapshot
from tests.render.conftest import Render
from tests.support.ray_cast import cast, flow_by_arithmetic
from tests.support.tiny_scenes import (
    FRAME_NS,
    Thing,
    box_mesh,
    camera_at,
    checker,
    contents_of,
    mesh_of,
    model_of,
    moved,
    snapshot_of,
    wall_mesh,
)

BOX = model_of(box_mesh(0.6))
WALL = model_of(wall_mesh(400.0, 400.0))
VIEWS = ("depth", "category", "instance", "flow", "flow_valid", "occlusion")


@pytest.fixture(scope="module")
def tiny_renderer() -> Iterator[TinyRenderer]:
    """The fallback under test."""
    made = TinyRenderer()
    yield made
    made.close()


@pytest.fixture
def tiny(tiny_renderer: TinyRenderer) -> Render:
    """Render with the fallback, called as ``render`` is."""

    def call(
        snapshot: WorldSnapshot,
        camera: Camera,
        *views: str,
        past: tuple[WorldSnapshot, Camera] | None = None,
    ) -> dict[str, NDArray[Any]]:
        previous = None if past is None else Observation(snapshot=past[0], camera=past[1])
        return dict(tiny_renderer.render(snapshot, previous, camera, views).views)

    return call


def strewn(seed: int, count: int = 14) -> list[Thing]:
    """Boxes before a floor and a wall."""
    rng = np.random.default_rng(seed)
    floor = Thing(WALL, Pose.from_rpy_deg((0, 0, -1.5), (0, 90, 0)), category_id=4)
    things = [Thing(WALL, Pose((9.0, 0.0, 0.0))), floor]
    for _ in range(count):
        position = (rng.uniform(1.5, 6.0), rng.uniform(-2.0, 2.0), rng.uniform(-1.4, 1.5))
        pose = Pose.from_rpy_deg(position, rng.uniform(-180, 180, 3))
        x, y, z = rng.uniform(0.3, 2.0, 3)
        things.append(Thing(BOX, pose, (x, y, z), category_id=int(rng.integers(1, 60))))
    return things


def beside_edges(instance: NDArray[np.uint16]) -> NDArray[np.bool_]:
    """Pixels with another id among the eight around them, and the picture's rim."""
    result = np.zeros(instance.shape, bool)
    for dv in (-1, 0, 1):
        for du in (-1, 0, 1):
            result |= np.roll(instance, (dv, du), (0, 1)) != instance
    return result


@pytest.mark.parametrize("seed", range(4))
def test_labels_and_depth_agree_with_rays(tiny: Render, seed: int) -> None:
    """Away from edges every id is that of the ray's body, and depth is right to 1e-4."""
    camera = camera_at(width=120, height=90)
    scene = snapshot_of(strewn(seed))
    views = tiny(scene, camera, "instance", "category", "depth")
    hits = cast(scene, camera)
    sure = hits.away_from_edges()
    ids = np.concatenate([scene.contents.instance_ids, [0]])
    assert sure.mean() > 0.3
    np.testing.assert_array_equal(views["instance"][sure], ids[hits.row[sure]])
    np.testing.assert_allclose(views["depth"][sure], hits.depth[sure], rtol=1e-4)
    table = scene.contents.category_of_instance
    np.testing.assert_array_equal(views["category"], table[views["instance"]])


@pytest.mark.parametrize("seed", range(4, 8))
@pytest.mark.parametrize(("near", "far"), [(0.05, 100.0), (0.5, 20.0)])
def test_both_renderers_tell_the_same(
    tiny: Render, render: Render, seed: int, near: float, far: float
) -> None:
    """Ids are equal but at edges, depth to 1e-4, flow to a thousandth of itself, validity too."""
    things = strewn(seed)
    rng = np.random.default_rng(seed)
    poses = [things[0].pose, things[1].pose]
    for thing in things[2:]:
        place = np.add(thing.pose.position_m, rng.uniform(-0.05, 0.05, 3))
        poses.append(Pose.from_rpy_deg(place, np.add(thing.pose.rpy_deg, rng.uniform(-4, 4, 3))))
    contents = contents_of(things)
    before = snapshot_of(things, contents=contents)
    after = snapshot_of(moved(things, *poses), contents=contents, time_ns=FRAME_NS)
    size = {"width": 161, "height": 120, "near_m": near, "far_m": far}
    then, now = camera_at(**size), camera_at(Pose.from_rpy_deg((0.02, 0.03, 0), (1, 0, 1)), **size)
    fast = render(after, now, *VIEWS, past=(before, then))
    slow = tiny(after, now, *VIEWS, past=(before, then))
    inside = ~beside_edges(fast["instance"])
    assert inside.mean() > 0.5
    np.testing.assert_array_equal(slow["instance"][inside], fast["instance"][inside])
    np.testing.assert_array_equal(slow["category"][inside], fast["category"][inside])
    assert (slow["instance"] != fast["instance"]).mean() < 0.002
    same = slow["instance"] == fast["instance"]
    np.testing.assert_array_equal(slow["flow_valid"][same], fast["flow_valid"][same])
    np.testing.assert_allclose(slow["depth"][inside], fast["depth"][inside], rtol=1e-4)
    # Edges of one body against itself are edges too: where depths differ there is another face.
    alike = inside & (np.abs(slow["depth"] / fast["depth"] - 1) < 1e-4)
    np.testing.assert_allclose(slow["flow"][alike], fast["flow"][alike], rtol=1e-3, atol=2e-2)
    assert (slow["occlusion"] != fast["occlusion"])[same].mean() < 0.005


@pytest.mark.parametrize("distance", [0.75, 3.0, 17.5, 80.0])
@pytest.mark.parametrize(("near", "far"), [(0.05, 100.0), (0.5, 90.0)])
def test_a_wall_ahead_has_one_depth(tiny: Render, distance: float, near: float, far: float) -> None:
    """A plane at right angles to the axis has the same depth everywhere, to 1e-4."""
    scene = snapshot_of([Thing(WALL, Pose((distance, 0.0, 0.0)))])
    depth = tiny(scene, camera_at(near_m=near, far_m=far), "depth")["depth"]
    np.testing.assert_allclose(depth, distance, rtol=1e-4)


def test_flow_is_the_arithmetic_s(tiny: Render) -> None:
    """A tumbling box before a moving camera: within a thousandth of a pixel per frame."""
    things = [Thing(BOX, Pose.from_rpy_deg((2.0, 0.1, 0.1), (5, 15, 25)), (2.0, 1.0, 1.5))]
    contents = contents_of(things)
    before = snapshot_of(things, contents=contents)
    pose = Pose.from_rpy_deg((1.95, 0.15, 0.08), (8, 12, 30))
    after = snapshot_of(moved(things, pose), contents=contents, time_ns=FRAME_NS)
    then, now = camera_at(), camera_at(Pose.from_rpy_deg((0.05, 0.02, -0.04), (1, -2, 2)))
    views = tiny(after, now, "flow", "flow_valid", past=(before, then))
    hits = cast(after, now)
    sure = hits.away_from_edges()
    error = views["flow"][sure] - flow_by_arithmetic(hits, after, now, before, then)[sure]
    assert views["flow_valid"].all()
    assert np.abs(error).max() * FRAME_NS * 1e-9 < 1e-3


def test_a_still_world_has_no_flow_at_all(tiny: Render) -> None:
    """Still camera, still bodies: exactly 0.0, valid, nothing occluded."""
    things = strewn(3)
    camera = camera_at(Pose.from_rpy_deg((0.1, 0.2, 0.3), (1, 2, 3)))
    contents = contents_of(things)
    before = snapshot_of(things, contents=contents)
    after = snapshot_of(things, contents=contents, time_ns=FRAME_NS)
    views = tiny(after, camera, "flow", "flow_valid", "occlusion", past=(before, camera))
    assert not views["flow"].any()
    assert views["flow_valid"].all()
    assert not views["occlusion"].any()


def test_without_a_past_flow_is_invalid(tiny: Render) -> None:
    """The first frame has no flow: NaN and not valid, everything occluded."""
    views = tiny(snapshot_of(strewn(1)), camera_at(), "flow", "flow_valid", "occlusion")
    assert np.isnan(views["flow"]).all()
    assert not views["flow_valid"].any()
    assert views["occlusion"].all()


def test_surfaces_short_of_near_and_beyond_far(tiny: Render) -> None:
    """At half of near a wall covers its pixels with NaN; beyond far it is nothing."""
    close_by = snapshot_of([Thing(WALL, Pose((0.25, 0, 0)))])
    close = tiny(close_by, camera_at(near_m=0.5), "depth", "instance")
    assert np.isnan(close["depth"]).all()
    assert (close["instance"] == 1).all()
    far_off = snapshot_of([Thing(WALL, Pose((25.0, 0, 0)))])
    distant = tiny(far_off, camera_at(far_m=20.0), "depth", "instance")
    assert np.isposinf(distant["depth"]).all()
    assert not distant["instance"].any()


def test_a_wall_through_the_camera(tiny: Render) -> None:
    """A side wall that runs from behind the camera to beyond far is cut at the right places."""
    side = Thing(WALL, Pose.from_rpy_deg((0.0, 0.3, 0.0), (0.0, 0.0, 90.0)))
    camera = camera_at(near_m=0.5, far_m=4.0, width=160)
    scene = snapshot_of([side])
    views = tiny(scene, camera, "depth", "instance")
    expected = cast(scene, camera).depth
    inside = (expected > 0.501) & (expected < 3.99)
    np.testing.assert_allclose(views["depth"][inside], expected[inside], rtol=1e-4)
    assert np.isnan(views["depth"][(expected > 0.2) & (expected < 0.499)]).all()
    assert np.isinf(views["depth"][expected > 4.01]).all()


@pytest.mark.parametrize(("width", "height"), [(8, 8), (9, 8), (641, 479), (33, 200)])
def test_any_size_gives_the_same_world(tiny: Render, width: int, height: int) -> None:
    """Odd sizes have no shifted rows: a slanted wall lies where rays meet it."""
    camera = camera_at(width=width, height=height)
    scene = snapshot_of([Thing(WALL, Pose.from_rpy_deg((4.0, 0, 0), (0.0, 20.0, 30.0)))])
    expected = cast(scene, camera).depth
    np.testing.assert_allclose(tiny(scene, camera, "depth")["depth"], expected, rtol=1e-4)


def test_depth_does_not_depend_on_the_distance_from_the_world_s_origin(tiny: Render) -> None:
    """The same view 2 km away from the origin has the same depth."""
    pose = Pose.from_rpy_deg((3.0, 0.0, 0.0), (0.0, 20.0, 30.0))
    away = Pose((2003.0, -1500.0, 300.0), pose.orientation_xyzw)
    camera = camera_at(Pose((2000.0, -1500.0, 300.0)))
    here = tiny(snapshot_of([Thing(WALL, pose)]), camera_at(), "depth")["depth"]
    there = tiny(snapshot_of([Thing(WALL, away)]), camera, "depth")["depth"]
    np.testing.assert_allclose(there, here, rtol=1e-5)


def test_backs_show_only_where_a_material_is_double_sided(tiny: Render) -> None:
    """A wall seen from behind hides nothing, unless both of its sides are drawn."""
    behind = Pose.from_rpy_deg((3.0, 0.0, 0.0), (0.0, 0.0, 180.0))
    one = snapshot_of([Thing(model_of(wall_mesh(9, 9)), behind)])
    two = snapshot_of([Thing(model_of(wall_mesh(9, 9), double_sided=True), behind)])
    assert not tiny(one, camera_at(), "instance")["instance"].any()
    assert tiny(two, camera_at(), "instance")["instance"].all()


def test_a_pane_of_glass_is_not_labelled(tiny: Render) -> None:
    """What a see-through material covers keeps its own id."""
    pane = model_of(wall_mesh(20, 20), alpha="blend")
    scene = snapshot_of([Thing(pane, Pose((2.0, 0, 0))), Thing(BOX, Pose((4.0, 0, 0)))])
    assert set(np.unique(tiny(scene, camera_at(), "instance")["instance"])) == {0, 2}


def test_a_mesh_of_any_size_is_drawn_whole(tiny: Render) -> None:
    """More vertices than PyBullet takes at once: no hole, one id."""
    count = 380
    y, z = np.meshgrid(np.linspace(5, -5, count), np.linspace(-5, 5, count))
    positions = np.stack([0 * y, y, z], axis=-1).reshape(-1, 3)
    first = (np.arange(count - 1)[:, None] * count + np.arange(count - 1)).reshape(-1)
    lower = np.stack([first, first + 1, first + count], axis=1)
    upper = np.stack([first + 1, first + count + 1, first + count], axis=1)
    normals = np.broadcast_to([-1.0, 0.0, 0.0], positions.shape)
    mesh = mesh_of(positions, normals, positions[:, 1:], np.concatenate([lower, upper]))
    scene = snapshot_of([Thing(model_of(mesh), Pose((2.0, 0, 0)))])
    views = tiny(scene, camera_at(), "instance", "depth")
    assert (views["instance"] == 1).all()
    np.testing.assert_allclose(views["depth"], 2.0, rtol=1e-4)


def test_a_scene_that_changes_is_drawn_as_it_is_now(tiny: Render) -> None:
    """New contents with new models, fewer and more of them, in any order; ids follow."""
    boxes = [Thing(BOX, Pose((4.0, y, 0))) for y in (0.8, -0.8)]
    wall = Thing(WALL, Pose((6.0, 0, 0)))
    for things in (boxes[:1], [*boxes, wall], [wall], [], [wall, *boxes]):
        scene = snapshot_of(things, first_id=40_000)
        ids = tiny(scene, camera_at(), "instance")["instance"]
        assert set(np.unique(ids)) - {0} == set(range(40_000, 40_000 + len(things)))
        assert (0 in ids) == (wall not in things)


def test_the_picture_shows_colours_textures_and_sky(tiny: Render) -> None:
    """A red box before a blue sky, a texture the right way up, light from where the sun is."""
    texture = np.full((64, 64, 4), 255, np.uint8)
    texture[:32, :32], texture[:32, 32:] = (255, 0, 0, 255), (0, 255, 0, 255)
    texture[32:, :32] = (0, 0, 255, 255)
    wall = model_of(wall_mesh(2.0, 2.0), base_colour_texture=texture, base_colour=(1, 1, 1, 1))
    rgb = tiny(snapshot_of([Thing(wall, Pose((2.0, 0, 0)))]), camera_at(), "rgb")["rgb"]
    assert [rgb[20, 30].argmax(), rgb[20, 66].argmax(), rgb[52, 30].argmax()] == [0, 1, 2]
    red = model_of(box_mesh(1.0), base_colour=(0.8, 0.05, 0.05, 1))
    scene = snapshot_of([Thing(red, Pose((3.0, 0, 0)))])
    views = tiny(scene, camera_at(look_at((0.0, 1.0, 1.5), (3.0, 0.0, 0.0))), "rgb", "instance")
    assert (views["rgb"][views["instance"] == 1].argmax(axis=-1) == 0).all()
    sky = tiny(snapshot_of([]), camera_at(), "rgb")["rgb"].astype(int)
    assert (sky[0, :, 2] > sky[0, :, 0]).all()
    plain = Environment(background="colour", background_colour=(1.0, 0.0, 0.0))
    red_sky = tiny(snapshot_of([], environment=plain), camera_at(), "rgb")["rgb"]
    assert (red_sky[..., 0] > 200).all()
    assert not red_sky[..., 1:].any()


def test_backgrounds_of_both_renderers_are_alike(tiny: Render, render: Render) -> None:
    """The sky is the same to two grey levels."""
    # Tall enough for the horizon not to be an edge, which one of them would smooth.
    camera = camera_at(Pose.from_rpy_deg((0, 0, 0), (5, -10, 40)), width=320, height=240)
    skies = [make(snapshot_of([]), camera, "rgb")["rgb"].astype(int) for make in (tiny, render)]
    assert np.abs(skies[0] - skies[1]).max() <= 2


def test_what_it_cannot_do_is_refused_in_words(tiny_renderer: TinyRenderer) -> None:
    """Normals are refused with the list of what there is; nothing else is disturbed."""
    with pytest.raises(InvalidRequest, match="this renderer makes: rgb, depth"):
        tiny_renderer.render(snapshot_of([]), None, camera_at(), ["normals"])
    assert tiny_renderer.render(snapshot_of([]), None, camera_at(), ["depth"]).views


def test_a_masked_material_is_drawn_whole_and_that_is_said(
    tiny: Render, caplog: pytest.LogCaptureFixture
) -> None:
    """TinyRenderer knows no alpha: one warning names the material."""
    leaf = model_of(wall_mesh(20, 20), name="leaf", alpha="mask", base_colour_texture=checker())
    scene = snapshot_of([Thing(leaf, Pose((2.0, 0, 0))), Thing(leaf, Pose((3.0, 0, 0)))])
    assert (tiny(scene, camera_at(), "instance")["instance"] == 1).all()
    assert [r.getMessage() for r in caplog.records if "'leaf'" in r.getMessage()] == [
        "the software renderer draws material 'leaf' without its holes: it knows no alpha"
    ]


def test_views_are_the_caller_s_own(tiny_renderer: TinyRenderer) -> None:
    """Writing into a view does not change the depth that the next frame refers to."""
    scene, camera = snapshot_of([Thing(WALL, Pose((2.0, 0, 0)))]), camera_at()
    rendered = tiny_renderer.render(scene, None, camera, ["depth"])
    rendered.views["depth"][:] = 7.0
    later = replace(scene, sim_time_ns=FRAME_NS)
    past = Observation(snapshot=scene, camera=camera, depth=rendered.depth)
    assert not tiny_renderer.render(later, past, camera, ["occlusion"]).views["occlusion"].any()


def test_a_closed_renderer_says_so() -> None:
    """Rendering after close is refused; closing twice does nothing."""
    made = TinyRenderer()
    made.close()
    made.close()
    with pytest.raises(RenderError, match="closed"):
        made.render(snapshot_of([]), None, camera_at(), ["depth"])
