"""Light on what can move, against arithmetic, and when it is worked out."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.light.relight import object_lights as module
from sailenv_ros.light.relight.baked_scene import albedo_of_model
from sailenv_ros.light.relight.movable_objects import MovableObjects
from sailenv_ros.light.relight.object_light import ObjectLighting, PlacedObject, SurfacePoints
from sailenv_ros.light.relight.object_lights import ObjectLights, with_object_light
from sailenv_ros.light.relight.quality import AT_VERTICES, FINE, QUICK, Quality
from sailenv_ros.light.relight.vertex_points import vertex_points
from sailenv_ros.types.baked_light import ObjectLight
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.model import Model, ModelPart
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.support.bake_scenes import ground
from tests.support.curved_meshes import bowl
from tests.support.movable_boxes import (
    BLACK,
    BOX,
    IN_THE_AIR,
    LAMP,
    WHITE_SKY,
    movable_objects,
    moved,
    room,
    scene_of,
    scene_on_disk,
)
from tests.support.tiny_scenes import box_mesh, model_of


def light_on(snapshot: WorldSnapshot, which: int = 0) -> ObjectLight:
    """The light on one of the things, with all others near."""
    things = movable_objects(snapshot)
    others = [thing for thing in things if thing is not things[which]]
    lighting = ObjectLighting(scene_of(snapshot), (), SurfacePoints())
    return lighting.light_on(things[which], others, FINE)


def value(
    light: ObjectLight,
    terms: NDArray[np.float32],
    normal: tuple[float, ...],
    point: tuple[float, ...],
) -> float:
    """The 28 terms of light_law.h."""
    along = light.axes @ np.asarray(normal)
    sides = [max(part, 0.0) ** 2 for part in along] + [min(part, 0.0) ** 2 for part in along]
    basis = [1, *normal, *np.outer(sides, [1, *point]).ravel()]
    return float(np.dot(basis, terms))


def test_in_an_even_sky_every_side_has_the_sky_light() -> None:
    """Irradiance / pi is the sky's radiance where a small black floor hides little of it."""
    found = light_on(room((BOX, Pose((0.0, 0.0, 9.0))), environment=WHITE_SKY))
    for normal in ((1, 0, 0), (0, -1, 0), (0, 0, 1)):
        at = tuple(0.1 * np.array(normal) + (0.0, 0.0, 9.0))
        assert value(found, found.bounced[0, :, 1], normal, at) == pytest.approx(0.8, rel=0.02)


def test_parts_colour_what_an_object_sends_out_by_their_areas() -> None:
    large, small = (
        model_of(box_mesh(size), base_colour=(*colour, 1.0), roughness=1.0)
        for size, colour in ((2.0, (1.0, 0.0, 0.0)), (1.0, (0.0, 0.0, 1.0)))
    )
    red, blue = (albedo_of_model(one).astype(float) for one in (large, small))
    both = albedo_of_model(Model(name="both", parts=large.parts + small.parts))
    np.testing.assert_allclose(both, 0.8 * red + 0.2 * blue, atol=1e-6)
    assert red[0] > 0.5 > blue[0]


def test_a_lamp_lights_by_distance_and_angle() -> None:
    """The top faces it at 0.9 m, so intensity / (pi 0.81); the bottom gets nothing."""
    found = light_on(room((BOX, IN_THE_AIR), lights=(LAMP,)))
    top = value(found, found.direct[1], (0, 0, 1), (0.0, 0.0, 1.1))
    assert top == pytest.approx(1.0 / (np.pi * 0.81), rel=0.1)
    assert abs(value(found, found.direct[1], (0, 0, -1), (0.0, 0.0, 0.9))) < 0.1 * top


def test_each_side_of_a_turned_board_has_its_own_light() -> None:
    """A lamp before an upright board: the front falls off as it should, the back stays dark."""
    board, turn = model_of(box_mesh((0.02, 0.8, 1.6)), base_colour=BLACK), 40.0
    pose = Pose.from_rpy_deg((0.0, 0.0, 1.0), (0.0, 0.0, turn))
    front = np.array([np.cos(np.radians(turn)), np.sin(np.radians(turn)), 0.0])
    across, lamp = np.array([-front[1], front[0], 0.0]), np.array([0.0, 0.0, 1.3]) + 1.1 * front
    found = light_on(room((board, pose), lights=(replace(LAMP, position_m=tuple(lamp)),)))
    given, wanted = [], []
    for beside in (-0.3, -0.1, 0.1, 0.3):
        for z in (0.4, 0.8, 1.2, 1.6):
            point = np.array([0.0, 0.0, z]) + 0.01 * front + beside * across
            way = lamp - point
            wanted.append(front @ way / (np.pi * np.linalg.norm(way) ** 3))
            given.append(value(found, found.direct[1], tuple(front), tuple(point)))
            back = value(found, found.direct[1], tuple(-front), tuple(point - 0.02 * front))
            assert abs(back) < 0.02 * wanted[-1]
    assert sum(given) == pytest.approx(sum(wanted), rel=0.03)
    assert np.std(np.subtract(given, wanted)) < 0.15 * np.mean(wanted)


def test_what_stands_between_takes_a_lamps_light() -> None:
    """A board under the lamp shades the box below; it is no part of the bake."""
    board = model_of(box_mesh((1.0, 1.0, 0.02)), base_colour=BLACK)
    shaded = light_on(room((BOX, IN_THE_AIR), (board, Pose((0.0, 0.0, 1.6))), lights=(LAMP,)))
    assert np.abs(shaded.direct).max() == 0.0


def _moved_part(part: ModelPart, by: tuple[float, ...]) -> ModelPart:
    positions = part.mesh.positions + np.array(by, np.float32)
    return replace(part, mesh=replace(part.mesh, positions=positions))


def test_light_in_an_open_box_comes_from_where_it_is_open() -> None:
    """Above a black floor its inner sides see sky wherever they see out; its outer ones, half."""
    half, tall, thick = 0.15, 0.15, 0.01
    walls = [
        ((thick, 2 * half, tall), (x, 0.0, 0.0)) for x in (-half + thick / 2, half - thick / 2)
    ]
    walls += [
        ((2 * half, thick, tall), (0.0, y, 0.0)) for y in (-half + thick / 2, half - thick / 2)
    ]
    walls.append(((2 * half, 2 * half, thick), (0.0, 0.0, -tall / 2)))
    parts = []
    for size, at in walls:
        (part,) = model_of(box_mesh(size), base_colour=BLACK).parts
        parts.append(_moved_part(part, at))
    box = Model(name="box", parts=tuple(parts))
    floor = ground(20.0, base_colour=BLACK)
    found = light_on(room((box, Pose((0.0, 0.0, 0.4))), environment=WHITE_SKY, floor=floor))
    for sign in (-1.0, 1.0):
        inner = value(
            found, found.bounced[0, :, 1], (-sign, 0, 0), (sign * (half - thick), 0.0, 0.4)
        )
        outer = value(found, found.bounced[0, :, 1], (sign, 0, 0), (sign * half, 0.0, 0.4))
        # Sides of one normal with unlike light, which 28 terms tell about.
        assert outer == pytest.approx(0.4, rel=0.1)
        assert inner == pytest.approx(0.8, rel=0.1)


@pytest.mark.parametrize(("radius_m", "soft", "most"), [(1.0, 0.05, 0.0), (0.08, 0.2, 0.4)])
def test_in_a_hollow_a_lamp_shines_where_it_is_seen(
    radius_m: float, soft: float, most: float
) -> None:
    """Half a sphere with a lamp beside: what the rim hides is dark, the rest as arithmetic says.

    The lamp is a ball of 6 cm: to a cup it is large, and so is the border of the rim's shadow.
    """
    half, middle = bowl(), np.array([0.0, 0.0, 2.0])
    sized = replace(half, positions=np.float32(radius_m) * half.positions)
    hollow = model_of(sized, base_colour=BLACK, roughness=1.0)
    lamp = np.array([1.6, 0.0, 3.0])
    lit = replace(LAMP, position_m=tuple(lamp.tolist()))
    snapshot = room((hollow, Pose((0.0, 0.0, 2.0))), lights=(lit,))
    found = ObjectLights().update(snapshot, scene_of(snapshot), (), threads=1)[2].found[1, :, 1]
    normals = hollow.normals.astype(np.float64)
    points = middle - radius_m * normals
    way = lamp - points
    wanted = (normals * way).sum(axis=1) / (np.pi * np.linalg.norm(way, axis=1) ** 3)
    through = points + way * ((2.0 - points[:, 2]) / way[:, 2])[:, None]
    away = np.linalg.norm(through[:, :2], axis=1) / radius_m
    inside, below = points[:, 2] < 2.0 - 0.1 * radius_m, (away < 1.0 - soft) & (wanted > 0.02)
    np.testing.assert_allclose(found[inside & below], wanted[inside & below], rtol=0.05)
    hidden = inside & (away > 1.05)
    assert np.abs(found[hidden]).max() <= most * wanted[hidden].max()
    assert np.abs(found[hidden]).mean() <= 0.5 * most * wanted[hidden].max()
    assert min((inside & below).sum(), hidden.sum()) > 60


def test_few_rays_leave_no_bright_dots_at_vertices() -> None:
    """One that met a lamp's shade is held to the open light; the others keep their quotient."""
    cup = bowl()
    points = vertex_points(model_of(replace(cup, positions=0.1 * cup.positions)))
    assert points is not None
    ramp = np.linspace(0.1, 0.3, len(points.positions)) * points.open_shares
    fitted = np.stack([ramp, 2.0 * ramp], axis=-1)[None]
    even, terms = points.at_vertices(0.7 * fitted, fitted)
    np.testing.assert_allclose(even, 0.7 * terms, rtol=1e-9)
    noisy = 0.7 * fitted
    noisy[0, 300] *= 40.0
    evened, _ = points.at_vertices(noisy, fitted)
    away = np.linalg.norm(0.1 * cup.positions - points.positions[300], axis=1)
    assert (evened / terms)[..., 0].max() < 1.0
    assert evened[..., 0].sum() > even[..., 0].sum()
    np.testing.assert_allclose(evened[0, away > 0.05], even[0, away > 0.05], rtol=1e-9)


def test_at_the_corners_of_a_large_face_light_is_that_of_the_face() -> None:
    """A panel in a frame that hides its edges: these say nothing of its middle."""
    (part,) = model_of(box_mesh((1.0, 1.0, 0.01)), base_colour=BLACK).parts
    rails = []
    for size, at in (
        ((1.0, 0.04, 0.3), (0.0, 0.48, 0.155)),
        ((1.0, 0.04, 0.3), (0.0, -0.48, 0.155)),
        ((0.04, 0.92, 0.3), (0.48, 0.0, 0.155)),
        ((0.04, 0.92, 0.3), (-0.48, 0.0, 0.155)),
    ):
        (rail,) = model_of(box_mesh(size), base_colour=BLACK).parts
        rails.append(_moved_part(rail, at))
    framed = Model(name="framed", parts=(part, *rails))
    assert vertex_points(framed) is not None
    snapshot = room((framed, IN_THE_AIR), lights=(replace(LAMP, position_m=(0.0, 0.0, 4.0)),))
    lit = ObjectLights().update(snapshot, scene_of(snapshot), (), threads=1)[2]
    face = np.flatnonzero((framed.normals[:24, 2] > 0.9) & (framed.positions[:24, 2] > 0.0))
    # Straight below at 2.995 m; in the corners less, and the rails hide a narrow border.
    assert lit.found[1, face, 1].min() > 0.75 / (np.pi * 2.995**2)


@pytest.mark.parametrize(
    ("alpha", "roughness", "asked"),
    [("opaque", 0.1, True), ("blend", 0.1, False), ("blend", 0.9, True)],
)
def test_vertices_are_asked_of_what_hides_itself(
    alpha: Literal["opaque", "blend"], roughness: float, asked: bool
) -> None:
    """And of veils; not of what is convex or of glass."""
    hollow = model_of(bowl(), base_colour=(1.0, 1.0, 1.0, 0.5), roughness=roughness, alpha=alpha)
    assert vertex_points(BOX) is None
    assert (vertex_points(hollow) is not None) is asked


def test_sides_that_face_each_other_are_darker() -> None:
    """Of two black boxes side by side, 1 cm apart, the gap is dark and the other side is not."""
    pair = room((BOX, IN_THE_AIR), (BOX, Pose((0.21, 0.0, 1.0))), environment=WHITE_SKY)
    found = light_on(pair)
    inner = value(found, found.bounced[0, :, 0], (1, 0, 0), (0.1, 0.0, 1.0))
    outer = value(found, found.bounced[0, :, 0], (-1, 0, 0), (-0.1, 0.0, 1.0))
    assert inner < 0.35 * outer


def test_what_an_object_sends_back_knows_of_its_own_shadow() -> None:
    """Below a board over a grey floor, on average, against 20,000 paths by the floor to the sky."""
    board, height, half = model_of(box_mesh((0.6, 0.6, 0.02)), base_colour=BLACK), 0.1, 0.3
    grey = ground(6.0, base_colour=(0.5, 0.5, 0.5, 1.0), roughness=1.0)
    pose = Pose((0.0, 0.0, height + 0.01))
    snapshot = room((board, pose), environment=WHITE_SKY, floor=grey)
    lighting = ObjectLighting(scene_of(snapshot), (), SurfacePoints())
    (thing,) = movable_objects(snapshot)
    rng = np.random.default_rng(3)
    u, v, w, t = rng.random((4, 20_000))
    down, up = (height / np.sqrt(1.0 - x) * np.sqrt(x) for x in (u, w))
    turn, back = 2.0 * np.pi * v, 2.0 * np.pi * t
    x, y = rng.uniform(-half, half, (2, 20_000))
    x, y = x + down * np.cos(turn), y + down * np.sin(turn)
    met = np.maximum(np.abs(x + up * np.cos(back)), np.abs(y + up * np.sin(back))) < half
    at, facing = (0.0, 0.0, height), (0, 0, -1)
    plain, shaded = (
        lighting.light_on(thing, (), FINE, shading=shading) for shading in (False, True)
    )
    before, after = (value(one, one.bounced[0, :, 1], facing, at) for one in (plain, shaded))
    assert 0.05 < 1.0 - met.mean() < 0.5
    assert after / before == pytest.approx(1.0 - met.mean(), abs=0.05)


def assert_same(one: ObjectLight, two: ObjectLight) -> None:
    for name in ("bounced", "direct", "axes", "found", "fitted"):
        assert np.array_equal(getattr(one, name), getattr(two, name))


def test_light_is_a_function_of_what_stands_where() -> None:
    """Threads, and what was shown before, change no bit; what stands still keeps its mapping."""
    snapshot = room((BOX, IN_THE_AIR), (BOX, Pose((0.6, 0.0, 0.5))), lights=(LAMP,))
    scene = scene_of(snapshot)
    one, two = ObjectLights(), ObjectLights()
    first = one.update(snapshot, scene, (), threads=1)
    assert one.update(snapshot, scene, (), threads=1) is first
    away = one.update(moved(snapshot, 1, 0.3), scene, (), threads=1)
    back = one.update(snapshot, scene, (), threads=1)
    other = two.update(snapshot, scene, (), threads=4)
    late = ObjectLights().update(moved(snapshot, 1, 0.3), scene, (), threads=1)
    for light, same in ((back, first), (other, first), (late, away)):
        assert light.keys() == same.keys() == {2, 3}
        for id_, own in same.items():
            assert_same(own, light[id_])


def test_many_things_on_their_way_cost_little(monkeypatch: pytest.MonkeyPatch) -> None:
    """Only so many that move get light of their own, and of fewer rays until they rest."""
    monkeypatch.setattr(module, "MOST_MOVING", 1)
    things = ((BOX, IN_THE_AIR), (BOX, Pose((0.6, 0.0, 0.5))), (BOX, Pose((-0.6, 0.0, 0.5))))
    snapshot = room(*things, environment=WHITE_SKY)
    scene, lights = scene_of(snapshot), ObjectLights()
    rest = lights.update(snapshot, scene, (), threads=1)
    assert rest.keys() == {2, 3, 4}
    velocities = np.zeros((4, 2, 3))
    velocities[1:3, 0, 0] = 0.5
    shown = lights.update(replace(snapshot, velocities=velocities), scene, (), threads=1)
    assert shown.keys() == {2, 4}
    assert not np.array_equal(shown[2].bounced, rest[2].bounced)
    again = lights.update(snapshot, scene, (), threads=1)
    assert np.array_equal(again[2].bounced, rest[2].bounced)


def asked_qualities(monkeypatch: pytest.MonkeyPatch) -> list[Quality]:
    """A list to which the quality of all light is appended that is found from now on."""
    asked: list[Quality] = []
    of_one = ObjectLighting.light_on

    def light_on(self: ObjectLighting, *arguments: Any, **more: Any) -> ObjectLight:
        asked.append(arguments[-1])
        return of_one(self, *arguments, **more)

    monkeypatch.setattr(ObjectLighting, "light_on", light_on)
    return asked


def test_what_moves_near_an_object_that_rests_costs_little(monkeypatch: pytest.MonkeyPatch) -> None:
    """Few rays tell the difference that it makes, as if all were found anew with many."""
    asked = asked_qualities(monkeypatch)
    gap = 0.25
    snapshot = room((BOX, IN_THE_AIR), (BOX, Pose((gap, 0.0, 1.0))), environment=WHITE_SKY)
    scene, lights = scene_of(snapshot), ObjectLights()
    velocities = np.zeros((3, 2, 3))
    velocities[2, 0, 0] = 0.5
    passing = replace(snapshot, velocities=velocities)
    lights.update(passing, scene, (), threads=1)
    asked.clear()
    for away in (0.0, 0.02, 0.04):
        shown = lights.update(moved(passing, 2, gap + away), scene, (), threads=1)
    # The one that moves, and the difference that it makes to the other one.
    assert asked == 4 * [QUICK]
    rest = ObjectLights().update(moved(snapshot, 2, gap + 0.04), scene, (), threads=1)
    for normal in ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, 0, 1)):
        at = tuple(0.1 * np.array(normal) + (0.0, 0.0, 1.0))
        near, wanted = (value(one[2], one[2].bounced[0, :, 1], normal, at) for one in (shown, rest))
        assert near == pytest.approx(wanted, rel=0.08)


def test_light_on_what_rests_is_kept_of_a_beginning(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Of a bake on disk: it is what would be found, and is found once; later places are not."""
    monkeypatch.setenv("SAILENV_CACHE", str(tmp_path))
    hollow = model_of(bowl(12), base_colour=BLACK)
    snapshot = room((BOX, IN_THE_AIR), (hollow, Pose((0.4, 0.3, 1.0))), environment=WHITE_SKY)

    def seen() -> list[dict[int, ObjectLight]]:
        lights, scene = ObjectLights(), scene_on_disk(snapshot)
        places = snapshot, moved(snapshot, 1, -0.5)
        return [dict(lights.update(one, scene, (), threads=1)) for one in places]

    found = seen()
    assert len(list((tmp_path / "arrays").glob("object_light-*"))) == 1
    asked = asked_qualities(monkeypatch)
    read = seen()
    # Those that have one beside them send out light, and the one that has moved.
    assert asked.count(FINE) == 2
    for one, two in zip(found, read, strict=True):
        assert one.keys() == two.keys() == {2, 3}
        for id_ in one:
            assert_same(one[id_], two[id_])


def test_light_at_vertices_is_found_where_something_large_changes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Not again for what is small beside it, and not of what is small or moves."""
    asked = asked_qualities(monkeypatch)
    hollow, small = model_of(bowl(12), base_colour=BLACK), model_of(bowl(6), base_colour=BLACK)
    things = (hollow, IN_THE_AIR), (small, Pose((1.2, 0.0, 1.0))), (BOX, Pose((-1.1, 0.0, 1.0)))
    snapshot = room(*things, environment=WHITE_SKY)
    scene, lights = scene_of(snapshot), ObjectLights()
    first = lights.update(snapshot, scene, (), threads=1)
    assert asked.count(AT_VERTICES) == 2
    assert first[2].found.shape == first[2].fitted.shape == (1, len(hollow.positions), 2)
    assert not first[4].found.size
    asked.clear()
    later = lights.update(moved(snapshot, 3, -1.2), scene, (), threads=1)
    assert later[2].found is first[2].found
    assert later[3] is first[3]
    assert AT_VERTICES not in asked
    velocities = np.zeros((4, 2, 3))
    velocities[2, 0, 0] = 0.5
    passing = lights.update(replace(snapshot, velocities=velocities), scene, (), threads=1)
    assert not passing[3].found.size
    assert asked.count(AT_VERTICES) == 1
    assert not np.array_equal(passing[2].found, first[2].found)
    back = lights.update(snapshot, scene, (), threads=1)
    assert_same(back[2], first[2])
    assert_same(back[3], first[3])


def test_a_scene_that_begins_again_asks_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither as it began nor as it came to rest, also if one of these came twice between."""
    asked = asked_qualities(monkeypatch)
    hollow = model_of(bowl(12), base_colour=BLACK)
    snapshot = room((hollow, IN_THE_AIR), (BOX, Pose((-1.1, 0.0, 1.0))), environment=WHITE_SKY)
    scene, later = scene_of(snapshot), moved(snapshot, 2, -1.0)
    expected = [ObjectLights().update(one, scene, (), threads=1) for one in (snapshot, later)]
    assert AT_VERTICES in asked
    asked.clear()
    for places in (snapshot, later), (snapshot,), (snapshot, later):
        lights = ObjectLights()
        for place, light in zip(places, expected, strict=False):
            shown = lights.update(place, scene, (), threads=1)
            for id_, one in light.items():
                assert_same(shown[id_], one)
    assert not asked


def test_creeping_by_less_than_can_be_seen_changes_nothing() -> None:
    """Things that come to rest move for seconds by a few hundredths of a millimetre."""
    snapshot = room((BOX, IN_THE_AIR))
    scene, lights = scene_of(snapshot), ObjectLights()
    first = lights.update(snapshot, scene, (), threads=1)
    assert lights.update(moved(snapshot, 1, 3e-5), scene, (), threads=1) is first


def test_only_what_can_move_and_keeps_its_shape_is_lit() -> None:
    """Neither what was baked nor what deforms."""
    snapshot = room((BOX, IN_THE_AIR), (BOX, Pose((0.6, 0.0, 0.5))))
    contents = snapshot.contents
    *others, last = contents.instances
    instances = (*others, replace(last, deforms=True))
    seen = movable_objects(replace(snapshot, contents=replace(contents, instances=instances)))
    assert [thing.id for thing in seen] == [2]
    assert isinstance(seen[0], PlacedObject)


def still(snapshot: WorldSnapshot, row: int) -> WorldSnapshot:
    """The same with a thing that cannot move."""
    contents = snapshot.contents
    instances = list(contents.instances)
    instance = replace(instances[row].instance, static=True)
    instances[row] = replace(instances[row], instance=instance)
    return replace(snapshot, contents=replace(contents, instances=tuple(instances)))


def test_each_side_of_a_net_that_stands_still_has_its_own_light() -> None:
    """A lamp before it: the light map has nothing of a net, and it casts no shadow."""
    net = model_of(box_mesh((0.01, 0.8, 0.8)), base_colour=(1.0, 1.0, 1.0, 0.4), alpha="blend")
    lamp = replace(LAMP, position_m=(0.9, 0.0, 1.0))
    snapshot = still(room((net, IN_THE_AIR), lights=(lamp,)), 1)
    scene = scene_of(snapshot)
    lit = with_object_light(snapshot, scene, 1)
    light = lit.object_light[2]
    front = value(light, light.direct[1], (1, 0, 0), (0.0, 0.0, 1.0))
    back = value(light, light.direct[1], (-1, 0, 0), (0.0, 0.0, 1.0))
    assert front == pytest.approx(1.0 / (np.pi * 0.81), rel=0.25)
    assert abs(back) < 0.05 * front
    assert lit.contents.baked is not None
    assert not lit.contents.baked.casters


@pytest.mark.parametrize(("alpha", "own"), [(0.1, False), (0.4, True), (1.0, False)])
def test_what_a_map_has_and_clear_panes_have_no_light_of_their_own(alpha: float, own: bool) -> None:
    kind = "opaque" if alpha == 1.0 else "blend"
    sheet = model_of(box_mesh(0.2), base_colour=(1.0, 1.0, 1.0, alpha), alpha=kind)
    assert bool(movable_objects(still(room((sheet, IN_THE_AIR)), 1))) is own


def test_what_stands_still_is_the_same_object_from_snapshot_to_snapshot() -> None:
    """Only what has moved is made again; all is as if it was seen for the first time."""
    places = [Pose((x, 0.0, 0.101)) for x in (-0.8, -0.3, 0.2, 0.7)]
    snapshot = room(*((BOX, place) for place in places))
    followed, later = MovableObjects(), moved(snapshot, 2, 0.65)
    followed.follow(snapshot)
    before = list(followed.things)
    assert followed.near == [[1], [0, 2], [1, 3], [2]]
    followed.follow(moved(snapshot, 2, -0.3 + 1e-9))
    assert followed.things == before
    followed.follow(later)
    fresh = MovableObjects()
    fresh.follow(later)
    assert [one is other for one, other in zip(before, followed.things, strict=True)] == [
        True, False, True, True,
    ]  # fmt: skip
    assert followed.places == fresh.places == [thing.place for thing in fresh.things]
    assert followed.near == fresh.near == [[], [2, 3], [1, 3], [1, 2]]
    assert followed.around == fresh.around
    around = list(followed.around)
    followed.follow(moved(later, 4, 0.701))
    # The last one has moved, and stands near all but the first.
    assert [one is other for one, other in zip(around, followed.around, strict=True)] == [
        True, False, False, False,
    ]  # fmt: skip
    assert followed.around[1] == tuple(followed.places[place] for place in (1, 2, 3))
