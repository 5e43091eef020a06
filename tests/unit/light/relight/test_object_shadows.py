"""Shadows of what can move, against arithmetic, and what they depend on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.light.relight import object_shadows
from sailenv_ros.light.relight.baked_scene import BakedScene
from sailenv_ros.light.relight.baked_scene_store import BakedSceneStore
from sailenv_ros.light.relight.found_light import MOST, FoundLight
from sailenv_ros.light.relight.object_light import ObjectLighting, SurfacePoints
from sailenv_ros.light.relight.object_lights import ObjectLights
from sailenv_ros.light.relight.object_shadows import CHANGED, LEAST, WHOLE, ObjectShadows
from sailenv_ros.light.relight.quality import FINE
from sailenv_ros.light.relight.scene_changes import Change, PlacedInstance
from sailenv_ros.light.relight.shadow_maps import PointChanges
from sailenv_ros.light.relight.shown_shadows import ShownShadows
from sailenv_ros.light.relight.texel_changes import TexelChanges
from sailenv_ros.native.ray_types import RAY_LIGHT
from sailenv_ros.native.relight_kernels import gather_change
from sailenv_ros.rays.ray_patterns import low_discrepancy_points, sequence_points
from sailenv_ros.types.baked_light import BakedLight
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.light_shapes import light_record
from sailenv_ros.types.lights import Light
from sailenv_ros.types.model import Model, ModelPart
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.support.bake_scenes import DARK
from tests.support.movable_boxes import (
    BLACK,
    BOX,
    FLOOR,
    LAMP,
    WHITE_SKY,
    movable_objects,
    moved,
    room,
    scene_of,
    scene_on_disk,
)
from tests.support.tiny_scenes import box_mesh, mesh_of, model_of

BOARD = model_of(box_mesh((0.6, 0.4, 0.002)), base_colour=BLACK)
ON_THE_FLOOR = Pose((0.0, 0.0, 0.101))
SUN = Light(name="sun", type="directional", direction=(0.0, 0.0, -1.0))


def shadowed(
    snapshot: WorldSnapshot, changes: tuple[Change, ...] = (), threads: int = 1
) -> BakedLight:
    """The light of a scene with all shadows."""
    scene = scene_of(snapshot)
    shadows = ShownShadows(scene, SurfacePoints())
    return shadows.on(scene.baked, movable_objects(snapshot), changes, threads=threads)


def texels(
    snapshot: WorldSnapshot, layer: NDArray[np.float16]
) -> tuple[NDArray[np.float32], NDArray[np.float64]]:
    """Return (N, 2) places of texels on the floor, and the first channel of a layer there."""
    scene = scene_of(snapshot)
    values = layer.reshape(scene.side**2, -1)[scene.places, 0].astype(float)
    return scene.positions[:, :2], values


def reader(snapshot: WorldSnapshot, layer: NDArray[np.float16]) -> Callable[..., float]:
    """Return a function of x and y on the floor: what the nearest texel says."""
    places, values = texels(snapshot, layer)
    return lambda x, y: float(values[np.linalg.norm(places - (x, y), axis=1).argmin()])


def share_of_board(x: float, y: float, height: float) -> float:
    """Share of the light from everywhere that a board hides from a point below (Siegel, Howell)."""
    total = 0.0
    for a, sign_a in ((0.3 - x, 1), (-0.3 - x, -1)):
        for b, sign_b in ((0.2 - y, 1), (-0.2 - y, -1)):
            p, q = a / height, b / height
            of_p, of_q = np.sqrt(1 + p * p), np.sqrt(1 + q * q)
            corner = p / of_p * np.arctan(q / of_p) + q / of_q * np.arctan(p / of_q)
            total += sign_a * sign_b * corner / (2.0 * np.pi)
    return total


def test_a_board_takes_its_share_of_an_even_sky() -> None:
    """By the form factor, below it and beside it; far away nothing changes."""
    snapshot = room((BOARD, Pose((0.0, 0.0, 0.25))), environment=WHITE_SKY)
    places, values = texels(snapshot, shadowed(snapshot).layers[0].bounced)
    expected = [0.8 * (1.0 - share_of_board(x, y, 0.249)) for x, y in places.astype(float)]
    below = np.abs(places).max(axis=1) < 0.35
    np.testing.assert_allclose(values[below], np.array(expected)[below], atol=0.04)
    far = np.abs(places).min(axis=1) > 0.85
    np.testing.assert_allclose(values[far], 0.8, atol=0.01)


def test_a_lamps_shadow_is_where_it_falls() -> None:
    """A board half-way up throws a shadow twice its size, and nothing beyond."""
    snapshot = room((BOARD, Pose((0.0, 0.0, 1.0))), lights=(LAMP,))
    baked = snapshot.contents.baked
    assert baked is not None
    before, after = (
        reader(snapshot, light.layers[1].direct) for light in (baked, shadowed(snapshot))
    )
    assert before(0.45, 0.05) > 0.05
    assert after(0.45, 0.05) == 0.0
    assert after(0.05, 0.25) < 0.01 * before(0.05, 0.25)
    assert after(0.75, 0.05) == before(0.75, 0.05)
    assert after(0.05, 0.55) == before(0.05, 0.55)


def test_the_edge_of_a_panels_shadow_has_many_rays() -> None:
    """Half-way between panel and floor, a straight edge hides the panel bit by bit."""
    panel = Light(
        name="panel", type="area", position_m=(0.0, 0.0, 2.0), direction=(0.0, 0.0, -1.0),
        width_m=0.6, height_m=0.6,
    )  # fmt: skip
    board = model_of(box_mesh((2.0, 4.0, 0.002)), base_colour=BLACK)
    snapshot = room((board, Pose((-1.0, 0.0, 1.0))), lights=(panel,))
    lighting = ObjectLighting(scene_of(snapshot), (), SurfacePoints())
    placed = lighting.placed(movable_objects(snapshot)[0])
    x = np.linspace(-0.5, 0.5, 201, dtype=np.float32)
    points = np.stack([x, np.full_like(x, 0.05), np.zeros_like(x)], axis=1)
    up = np.tile(np.array([0, 0, 1], np.float32), (len(x), 1))

    def direct(more: list[PlacedInstance], wanted: int, rays: int) -> NDArray[np.float32]:
        world = lighting.world.with_more(more)  # whose arrays the record points to
        found = gather_change(
            world.record, points, up,
            np.full(len(x), wanted, np.uint8), sequence_points(16), light_record(panel),
            sequence_points(rays), 0.0, inside_share=0.5, most_changed=1.0, threads=1,
        )  # fmt: skip
        return found[2][:, 0]

    after = replace(placed, before=False)
    # The edge is seen against the panel at - x, and the panel ends at 0.3 m.
    expected = np.clip((0.3 + x) / 0.6, 0.0, 1.0)
    edge = np.abs(x) < 0.25
    for rays, most in ((FINE.area_rays, 0.02), (16, 0.06)):
        open_sky = direct([], WHOLE, rays)
        taken = -direct([after], CHANGED, rays) / open_sky
        left = direct([after], WHOLE, rays) / open_sky
        for share in (1.0 - taken, left):
            off = share - expected
            assert np.sqrt(np.mean(off[edge] ** 2)) < most
            # Elsewhere few rays say the same as many.
            assert np.abs(off[np.abs(x) > 0.35]).max() < 1e-5


def test_texels_are_asked_wherever_a_soft_shadow_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    """Under a panel, slats throw thin shadows, which single patches miss: no square is left out."""
    panel = Light(
        name="panel", type="area", position_m=(0.0, 0.0, 2.0), direction=(0.0, 0.0, -1.0),
        width_m=0.4, height_m=0.4,
    )  # fmt: skip
    slat = model_of(box_mesh((0.03, 1.4, 0.002)), base_colour=BLACK)
    places = np.linspace(-0.6, 0.6, 9)
    snapshot = room(*((slat, Pose((x, 0.0, 0.3))) for x in places), lights=(panel,))
    baked = snapshot.contents.baked
    assert baked is not None
    _, before = texels(snapshot, baked.layers[1].direct)
    shares = []
    for least in (object_shadows.LEAST_SOFT, -1.0):
        monkeypatch.setattr(object_shadows, "LEAST_SOFT", least)
        _, after = texels(snapshot, shadowed(snapshot).layers[1].direct)
        shares.append(after / before)
    assert shares[1].min() < 0.8
    assert np.abs(shares[0] - shares[1]).max() < 0.02


GLOWING_M, RADIANCE = 0.04, 200.0


def under_a_lamp(*things: tuple[Model, Pose]) -> WorldSnapshot:
    """A floor 2 m below a small glowing cube."""
    cube, ground = box_mesh(GLOWING_M), FLOOR.parts[0]
    positions = cube.positions + np.array([0.0, 0.0, 2.0])
    glowing = ModelPart(
        mesh=mesh_of(positions, cube.normals, cube.uvs, cube.triangles),
        material=replace(ground.material, emission=(RADIANCE,) * 3),
    )
    return room(*things, floor=Model(name="floor and lamp", parts=(ground, glowing)))


def test_what_hides_a_small_emitter_takes_all_of_its_light() -> None:
    """A board half-way up: a shadow twice its size, and no stain beside."""
    snapshot = under_a_lamp((BOARD, Pose((0.0, 0.0, 1.0))))
    baked = snapshot.contents.baked
    assert baked is not None
    low = scene_of(snapshot).positions[:, 2] < 0.1
    places, before = (one[low] for one in texels(snapshot, baked.layers[0].bounced))
    after = texels(snapshot, shadowed(snapshot).layers[0].bounced)[1][low]
    beyond = (np.abs(places) / (0.6, 0.4)).max(axis=1)
    assert before.min() > 0.005
    left = after / before
    # Single rays would leave all or nothing.
    assert np.sqrt(np.mean(left[beyond < 0.75] ** 2)) < 0.2
    assert np.sqrt(np.mean((left - 1.0)[beyond > 1.5] ** 2)) < 0.04


def test_all_of_the_light_of_a_small_emitter_is_found_by_few_rays() -> None:
    """By the form factor of its lower side, at points that two rays in 10,000 would tell it."""
    lighting = ObjectLighting(scene_of(under_a_lamp()), (), SurfacePoints())
    points = np.random.default_rng(7).uniform(-0.1, 0.1, (500, 3)).astype(np.float32)
    points[:, 2] = 0.5
    up = np.tile(np.array([0, 0, 1], np.float32), (len(points), 1))
    _, bounced, *_ = gather_change(
        lighting.world.record, points, up, np.full(len(points), WHOLE, np.uint8),
        low_discrepancy_points(64), np.zeros(0, RAY_LIGHT), sequence_points(16), 0.0,
        inside_share=0.5, threads=1,
    )  # fmt: skip
    expected = RADIANCE * GLOWING_M**2 / (np.pi * (1.5 - GLOWING_M / 2.0) ** 2)
    found = bounced[:, 0] / expected
    assert found.mean() == pytest.approx(1.0, abs=0.05)
    assert found.std() < 0.6


def test_only_the_lit_side_of_a_thing_gives_light_back() -> None:
    """A lamp shines on an upright red board: the floor before it is lit, the one behind is not."""
    board = model_of(box_mesh((0.01, 1.6, 0.8)), base_colour=(0.8, 0.0, 0.0, 1.0))
    snapshot = room((board, Pose((0.4, 0.0, 0.4))), lights=(replace(LAMP, position_m=(-1, 0, 2)),))
    read = reader(snapshot, shadowed(snapshot).layers[1].bounced)
    # By the form factor of half of what is before it, at most.
    assert 0.004 < read(0.25, 0.05) < 0.5 * 0.8 / np.pi
    assert read(0.55, 0.05) < 0.1 * read(0.25, 0.05)


def test_the_sun_is_left_to_its_shadow_map() -> None:
    """It draws what can move in each picture: its shadow would else be there twice."""
    snapshot = room((BOX, ON_THE_FLOOR), environment=WHITE_SKY, lights=(SUN,))
    light, baked = shadowed(snapshot), snapshot.contents.baked
    assert baked is not None
    assert light.layers[1].direct is baked.layers[1].direct
    assert light.layers[1].visibility is baked.layers[1].visibility
    assert light.unshadowed is baked
    assert light.casters == {2}


def test_beside_a_box_it_is_darker_than_farther_away() -> None:
    """At its foot about half of the sky is hidden, as by an endless wall; it ends within 1 m."""
    snapshot = room((BOX, ON_THE_FLOOR), environment=WHITE_SKY)
    read = reader(snapshot, shadowed(snapshot).layers[0].bounced)
    row = [read(x, 0.05) for x in (0.15, 0.25, 0.35, 0.55, 0.95)]
    assert 0.4 * 0.8 < row[0] < 0.75 * 0.8
    assert (np.diff(row) > -0.01).all()
    assert row[-1] > 0.78


def test_shadows_are_a_function_of_what_stands_where() -> None:
    """Threads, and what was shown before, change no bit; without a change nothing is made."""
    panel = Light(name="panel", type="area", position_m=(0.5, 0.5, 2.0), direction=(0.0, 0.0, -1.0))
    boxes = [(BOX, Pose((x, y, 0.101))) for x, y in ((0.0, 0.0), (0.4, 0.3), (-0.6, 0.6))]
    snapshot = room(*boxes, environment=WHITE_SKY, lights=(LAMP, panel))
    scene = scene_of(snapshot)
    away = movable_objects(moved(snapshot, 1, -0.5))
    here = movable_objects(snapshot)
    shadows = ShownShadows(scene, SurfacePoints())
    first = shadows.on(scene.baked, here, (), threads=1)
    assert shadows.on(scene.baked, here, (), threads=1) is first
    second = shadows.on(scene.baked, away, (), threads=1)
    back = shadows.on(scene.baked, here, (), threads=1)
    fresh = ShownShadows(scene, SurfacePoints())
    assert_same(first, back)
    assert_same(second, fresh.on(scene.baked, away, (), threads=4))
    assert shadows.on(scene.baked, [], (), threads=1) is scene.baked


def test_shadows_that_were_kept_are_those_that_are_found(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Of a bake on disk the first ones are kept there, and those after a move that came twice."""
    monkeypatch.setenv("SAILENV_CACHE", str(tmp_path))
    snapshot = room((BOX, ON_THE_FLOOR), (BOX, Pose((0.4, 0.3, 0.101))), environment=WHITE_SKY)
    things = [movable_objects(one) for one in (snapshot, moved(snapshot, 1, -0.5))]

    def kept() -> int:
        return len(list((tmp_path / "arrays").glob("shadows-*")))

    def shown(scene: BakedScene) -> list[BakedLight]:
        shadows = ShownShadows(scene, SurfacePoints())
        return [shadows.on(scene.baked, one, (), threads=1) for one in things]

    scene = scene_on_disk(snapshot)
    found = shown(scene)
    assert kept() == 1
    again = shown(scene)
    assert kept() == 2
    with monkeypatch.context() as patched:
        patched.setattr(ObjectShadows, "update", lambda *_: pytest.fail("found anew"))
        read = shown(scene_on_disk(snapshot))
    for one, two, three in zip(found, again, read, strict=True):
        assert_same(one, two)
        assert_same(one, three)


def test_a_beginning_that_was_kept_has_its_next_shadows_kept(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """By the process that reads it; what chance does to others that begin is not kept."""
    monkeypatch.setenv("SAILENV_CACHE", str(tmp_path))
    snapshot = room((BOX, ON_THE_FLOOR), (BOX, Pose((0.4, 0.3, 0.101))), environment=WHITE_SKY)
    counts = []
    for _ in range(2):
        scene = scene_on_disk(snapshot)
        shadows = ShownShadows(scene, SurfacePoints())
        for by in (0.0, -0.5, -0.4, -0.3):
            things = movable_objects(moved(snapshot, 1, by))
            shadows.on(scene.baked, things, (), threads=1)
        counts.append(len(list((tmp_path / "arrays").glob("shadows-*"))))
    assert counts == [1, 2]


def test_where_nothing_that_moved_reaches_nothing_is_found_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A small box is felt within seven times its radius, before and after; the rest is known."""
    small = model_of(box_mesh((0.06, 0.06, 0.06)), base_colour=BLACK)
    places = [Pose((x, y, 0.031)) for x, y in ((-0.5, 0.0), (-0.3, 0.3), (-0.1, 0.0), (0.3, 0.2))]
    snapshot = room(*((small, place) for place in places), environment=WHITE_SKY)
    scene, things = scene_of(snapshot), movable_objects(snapshot)
    shadows = ShownShadows(scene, SurfacePoints())
    shadows.on(scene.baked, things, (), threads=1)
    asked: list[NDArray[np.float32]] = []

    def gathered(world: Any, positions: NDArray[np.float32], *rest: Any, **more: Any) -> Any:
        asked.append(positions[more["numbers"] >= len(scene.patches.size)])  # texels
        return gather_change(world, positions, *rest, **more)

    monkeypatch.setattr(object_shadows, "gather_change", gathered)
    away = moved(snapshot, 1, -0.55)
    light = shadows.on(scene.baked, movable_objects(away), (), threads=1)
    centres = np.array([(-0.5, 0.0, 0.031), (-0.55, 0.0, 0.031)])
    apart = np.linalg.norm(np.concatenate(asked)[:, None] - centres, axis=2).min(axis=1)
    assert 0.0 < apart.max() < 0.03 * np.sqrt(3.0 / LEAST)
    assert_same(light, shadowed(away))


def test_texels_tell_how_long_what_was_found_holds() -> None:
    """Until something reaches them, and for as many rays; in the order of the scene."""
    values = PointChanges(
        np.array([1, 2, 3], np.uint8), np.arange(3.0, dtype=np.float32)[:, None], np.ones(3, "f4")
    )
    texels = TexelChanges.fresh(np.array([3, 5, 9]), 64, values)
    known, found = texels.known(np.array([2, 5, 9, 11]), 64)
    assert known.tolist() == [False, True, True, False]
    assert found.change[:, 0].tolist() == [1.0, 2.0]
    assert not texels.known(np.array([5]), 256)[0].any()
    later = texels.after(np.array([False, True, False]))
    assert later.known(np.array([3, 5, 9]), 64)[0].tolist() == [True, False, True]
    other = TexelChanges.fresh(np.array([5, 7]), 256, values.at(np.array([2, 0])))
    both = later.replaced(np.array([True, False, True]), [other])
    assert both.texels.tolist() == [3, 5, 7, 9]
    assert both.rays.tolist() == [64, 256, 256, 64]
    assert both.found.change[:, 0].tolist() == [0.0, 2.0, 0.0, 2.0]
    assert not both.outdated.any()
    for one, two in zip(TexelChanges.of(both.arrays())[:3], both[:3], strict=True):
        np.testing.assert_array_equal(one, two)


def test_beginnings_that_come_again_are_kept_longest() -> None:
    """What chance has made of them goes first."""

    class Shadows:
        def copy(self) -> Shadows:
            return self

    found = FoundLight()
    begin, next_ = ("begin",), ("begin", "next")
    for places in (begin, next_):
        found.keep(places, Shadows())
        found.asked.add(places)
    for number in range(2 * MOST):
        found.keep(("begin", "next", number), Shadows())
    assert len(found.shadows) == MOST
    assert {begin, next_} < set(found.shadows)


def assert_same(one: BakedLight, two: BakedLight) -> None:
    """Of two lights all maps are equal."""
    assert one.casters == two.casters
    for layer, other in zip(one.layers, two.layers, strict=True):
        assert np.array_equal(layer.direct, other.direct)
        assert np.array_equal(layer.bounced, other.bounced)


def test_a_floor_that_is_gone_has_no_shadow_and_what_came_hides_one() -> None:
    """Near furniture that has changed shadows are found again, whatever was known before."""
    snapshot = room((BOX, ON_THE_FLOOR), environment=WHITE_SKY)
    scene, things = scene_of(snapshot), movable_objects(snapshot)
    wide = model_of(box_mesh((1.9, 1.9, 0.3)), base_colour=BLACK)
    pose = np.eye(4)
    pose[2, 3] = 0.4
    came = Change(id=9, before=None, after=pose, came=(wide, (1.0, 1.0, 1.0)))
    shadows = ShownShadows(scene, SurfacePoints())
    open_, under = (
        shadows.on(scene.baked, things, changes, threads=1) for changes in ((), (came,))
    )
    lost = [reader(snapshot, light.layers[0].bounced)(0.15, 0.05) for light in (open_, under)]
    assert lost[0] < 0.65
    assert lost[1] > lost[0] + 0.05
    assert_same(under, shadowed(snapshot, (came,)))
    moved_away = replace(snapshot, contents=snapshot.contents)
    assert_same(open_, shadowed(moved_away))


def test_a_scene_that_begins_again_has_its_shadows_and_light_at_once() -> None:
    """As it began, and after a thing has moved: what was found is shown, nothing is found anew."""
    began = room((BOX, ON_THE_FLOOR), environment=WHITE_SKY, lights=(LAMP,))
    later, elsewhere = moved(began, 1, 0.3), moved(began, 1, -0.4)
    store = BakedSceneStore()
    shown = []
    for _ in range(2):
        scene = store.scene_of(began.contents, 1)
        lights = ObjectLights()
        shadows = ShownShadows(scene, lights.points)
        for snapshot in (began, later):
            light = lights.update(snapshot, scene, (), threads=1)
            on = shadows.on(scene.baked, movable_objects(snapshot), (), threads=1)
            shown.append((light, on))
    for (light, on), (again, on_again) in zip(shown[:2], shown[2:], strict=True):
        assert on_again.layers[0].bounced is on.layers[0].bounced
        assert on_again.layers[1].direct is on.layers[1].direct
        assert on_again.casters == on.casters
        for id_, one in light.items():
            np.testing.assert_array_equal(one.bounced, again[id_].bounced)
    # What is kept is as it was found, though one who took it went on from there.
    last = shadows.on(scene.baked, movable_objects(elsewhere), (), threads=1)
    np.testing.assert_array_equal(last.layers[0].bounced, shadowed(elsewhere).layers[0].bounced)
    third = ShownShadows(store.scene_of(began.contents, 1), SurfacePoints())
    for snapshot in (began, elsewhere):
        on = third.on(scene.baked, movable_objects(snapshot), (), threads=1)
        expected = shadowed(snapshot).layers[0].bounced
        np.testing.assert_array_equal(on.layers[0].bounced, expected)


def test_what_is_kept_of_a_scene_is_little() -> None:
    """However often its things move, and under another sky nothing is."""
    snapshot = room((BOX, ON_THE_FLOOR), environment=WHITE_SKY)
    store = BakedSceneStore()
    scene = store.scene_of(snapshot.contents, 1)
    for turn in range(2):
        shadows = ShownShadows(scene, SurfacePoints())
        for step in range(4):
            place = moved(snapshot, 1, 0.1 * step + 0.05 * turn)
            shadows.on(scene.baked, movable_objects(place), (), threads=1)
    assert len(scene.found.shadows) == MOST
    assert store.scene_of(snapshot.contents, 1).found is scene.found
    dark = replace(snapshot.contents, environment=DARK)
    assert not store.scene_of(dark, 1).found.shadows
