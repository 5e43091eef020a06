"""Light that is brought up to date after a move, against light that is baked anew."""

from __future__ import annotations

import gc
import weakref
from dataclasses import replace

import numpy as np
import pytest

from sailenv_ros.light.bake.pipeline import bake
from sailenv_ros.light.relight.baked_scene import BakedScene
from sailenv_ros.light.relight.quality import FINE, QUICK, Quality
from sailenv_ros.light.relight.ray_world import ray_world
from sailenv_ros.light.relight.relighting import relit
from sailenv_ros.light.relight.scene_changes import Change
from sailenv_ros.rays.triangle_tree import triangle_tree
from sailenv_ros.types.baked_light import BakedLight
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Environment, Light
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.support.bake_scenes import COARSE, hollow, read, still
from tests.support.tiny_scenes import Thing, box_mesh, model_of

ROOM = Thing(hollow((6.0, 6.0, 3.0), base_colour=(0.7, 0.6, 0.5, 1.0)), Pose((0.0, 0.0, 1.5)))
CHEST = model_of(box_mesh((1.0, 0.6, 1.0)), base_colour=(0.4, 0.5, 0.6, 1.0))
HERE, THERE = Pose((-1.6, -1.2, 0.52)), Pose((1.2, 0.9, 0.52))
LAMP = Light(name="lamp", type="point", position_m=(0.2, 0.1, 2.4), intensity=1.0)
PANEL = Light(
    name="panel", type="area", position_m=(-2.9, 0.0, 1.5), direction=(1, 0, 0), height_m=1.2
)
SPOT = Light(name="spot", type="spot", position_m=(-1.6, -1.2, 2.8), outer_cone_deg=50)
LIGHTS = (LAMP, PANEL, SPOT)
FINER = replace(COARSE, rays=256)


def room(at: Pose) -> WorldSnapshot:
    """A room with a chest."""
    return still([ROOM, Thing(CHEST, at)], lights=LIGHTS, environment=Environment())


def scene_of(snapshot: WorldSnapshot) -> BakedScene:
    """The scene, baked."""
    return BakedScene(bake(snapshot, settings=FINER), snapshot.contents, 2)


@pytest.fixture(scope="module")
def scene() -> BakedScene:
    """The room with the chest here, baked."""
    return scene_of(room(HERE))


@pytest.fixture(scope="module")
def anew() -> BakedLight:
    """The room with the chest there, baked."""
    return bake(room(THERE), settings=FINER)


def moved(scene: BakedScene, quality: Quality = FINE, threads: int = 2) -> BakedLight:
    """The chest moved from here to there."""
    change = Change(id=2, before=HERE.matrix(), after=THERE.matrix())
    return relit(scene, [change], quality, threads=threads)


def light_at(baked: BakedLight, snapshot: WorldSnapshot, instance: int) -> np.ndarray:
    """What arrives in all at points of an instance, from every layer: (L, N)."""
    return np.array(
        [
            read(baked, instance, snapshot, layer.bounced)[1].mean(axis=1)
            + read(baked, instance, snapshot, layer.direct)[1]
            for layer in baked.layers
        ]
    )


def test_what_kernels_read_lives_as_long_as_their_record(scene: BakedScene) -> None:
    """Its addresses are numbers: without the world that it is of, arrays would be free memory."""
    radiance = np.zeros((len(scene.patches.size), 3), np.float32)
    living = weakref.ref(radiance)
    record = ray_world(scene, (), radiance, radiance).with_more(()).record
    shape = triangle_tree(np.eye(3, dtype=np.float32)[None]).record
    del radiance
    gc.collect()
    assert living() is not None
    addresses = [array.ctypes.data for array in shape.kept if array is not None]
    assert int(shape["nodes_at"][0]) in addresses
    assert shape.copy().kept == shape.kept
    del record
    assert living() is None


@pytest.mark.parametrize(("quality", "most"), [(QUICK, 0.2), (FINE, 0.1)])
def test_a_moved_chest_is_lit_as_if_baked_there(
    scene: BakedScene, anew: BakedLight, quality: Quality, most: float
) -> None:
    """On the room and on the chest itself, the mean error is a small part of the mean light."""
    got, snapshot = moved(scene, quality), room(THERE)
    for instance in (1, 2):
        mine, expected = (light_at(light, snapshot, instance) for light in (got, anew))
        # The bottom of the chest is seen by nobody.
        seen = expected.sum(axis=0) > 0.02
        error = np.abs(mine - expected)[:, seen].mean(axis=1)
        assert (error <= most * expected[:, seen].mean(axis=1) + 5e-4).all()


def within(points: np.ndarray, radius: float) -> np.ndarray:
    """Return which points lie on the floor around the first place of the chest."""
    far = np.linalg.norm(points[:, :2] - HERE.position_m[:2], axis=1)
    return np.asarray((np.abs(points[:, 2]) < 1e-3) & (far < radius))


def test_a_glowing_shade_lights_what_a_move_uncovers() -> None:
    """A lamp that shines through its shade alone lights the floor where a chest stood."""
    at = (-1.6, -1.2, 2.2)
    shade = model_of(box_mesh(0.4), base_colour=(0.0, 0.0, 0.0, 1.0), glow=(3.0, 2.0, 1.0))
    lamp = Light(name="lamp", type="point", position_m=at)

    def lit_room(chest: Pose) -> WorldSnapshot:
        things = [ROOM, Thing(CHEST, chest), Thing(shade, Pose(at), lit_by=("lamp",))]
        return still(things, lights=(lamp,), environment=Environment())

    settings = replace(COARSE, texel_m=0.1)
    before, after = lit_room(HERE), lit_room(THERE)
    scene = BakedScene(bake(before, settings=settings), before.contents, 2)
    got, anew = moved(scene), bake(after, settings=settings)
    points, mine = read(got, 1, after, got.layers[1].bounced)
    _, expected = read(anew, 1, after, anew.layers[1].bounced)
    near = within(points, 0.5)
    assert expected[near].mean() > 0.02
    assert mine[near].mean(axis=0) == pytest.approx(expected[near].mean(axis=0), rel=0.05)


def test_no_ghost_is_left(scene: BakedScene, anew: BakedLight) -> None:
    """The floor under the chest was dark; now it has the light that it would have had."""
    snapshot = room(THERE)
    before, got = scene.baked, moved(scene)
    places = scene.positions
    under = (np.abs(places[:, 2]) < 1e-3) & (
        np.hypot(*(places[:, :2] - HERE.position_m[:2]).T) < 0.25
    )
    at = scene.places[under]
    assert at.size > 10

    def light(baked: BakedLight) -> float:
        return float(sum(layer.bounced.reshape(-1, 3)[at].mean() for layer in baked.layers))

    bounced = np.sum([layer.bounced.astype(float) for layer in anew.layers], axis=0)
    points, expected = read(anew, 1, snapshot, bounced)
    near = within(points, 0.6)
    assert near.any()
    assert light(before) < 0.4 * expected[near].mean()
    assert light(got) == pytest.approx(expected[near].mean(), rel=0.15)


def test_sharp_edges_stay_where_light_is_the_same(scene: BakedScene) -> None:
    """Blocks of shadows' edges go where the share of the sun has changed, and nowhere else."""
    for before, after in zip(scene.baked.layers, moved(scene).layers, strict=True):
        assert (before.edges is None) == (after.edges is None)
        if before.edges is None or after.edges is None:
            continue
        assert before.visibility is not None
        assert after.visibility is not None
        changed = before.visibility != after.visibility
        assert changed.any()
        np.testing.assert_array_equal(after.edges.index[~changed], before.edges.index[~changed])
        assert (after.edges.index[changed] == -1).all()
        assert after.edges.blocks is before.edges.blocks


def test_where_nothing_moves_nothing_changes(scene: BakedScene) -> None:
    """A chest that moves to where it stands changes no light but by rays that hit its own faces."""
    got = relit(scene, [], FINE, threads=2)
    for before, after in zip(scene.baked.layers, got.layers, strict=True):
        assert np.array_equal(before.bounced, after.bounced)
        assert np.array_equal(before.direct, after.direct)
        assert np.array_equal(before.probe_bounced, after.probe_bounced)


def arrays(baked: BakedLight) -> list[np.ndarray]:
    """All that relighting may change."""
    return [
        array
        for layer in baked.layers
        for array in (layer.direct, layer.bounced, layer.probe_direct, layer.probe_bounced)
    ]


def test_the_bake_stays_as_it_is(scene: BakedScene) -> None:
    """Moves and paint make light of their own, from the same bytes each time."""
    before = [array.tobytes() for array in arrays(scene.baked)]
    first = moved(scene, QUICK)
    relit(scene, [], QUICK, threads=2, painted={1: BLUE.model})
    again = moved(scene, QUICK)
    assert [array.tobytes() for array in arrays(scene.baked)] == before
    for one, two in zip(arrays(first), arrays(again), strict=True):
        assert one.tobytes() == two.tobytes()
    assert [array.tobytes() for array in arrays(first)] != before


def test_probes_inside_what_moved_keep_their_light(scene: BakedScene) -> None:
    """Nobody sees them there, and what stands around would be lit by them; others change."""
    grid = scene.baked.probes
    places = np.stack(np.indices(grid.shape)[::-1], axis=-1).reshape(-1, 3)
    points = places * grid.spacing_m + grid.origin_m
    middle = points[np.linalg.norm(points - (0.5, 0.5, 1.5), axis=1).argmin()]
    change = Change(id=2, before=HERE.matrix(), after=Pose(tuple(middle)).matrix())
    got = relit(scene, [change], FINE, threads=2)
    inside = (np.abs(points - middle) < (0.5, 0.3, 0.5)).all(axis=1)
    assert inside.any()
    changed = np.zeros(len(points), bool)
    for before, after in zip(scene.baked.layers, got.layers, strict=True):
        change_of = after.probe_bounced.astype(float) - before.probe_bounced.astype(float)
        changed |= np.abs(change_of).reshape(len(points), -1).max(axis=1) > 0.0
    assert not changed[inside].any()
    assert changed[~inside].sum() > 10


def test_the_result_does_not_depend_on_threads(scene: BakedScene) -> None:
    """One thread and three give the same bytes."""
    one, three = moved(scene, threads=1), moved(scene, threads=3)
    for a, b in zip(one.layers, three.layers, strict=True):
        assert a.bounced.tobytes() == b.bounced.tobytes()
        assert a.direct.tobytes() == b.direct.tobytes()
        assert a.probe_bounced.tobytes() == b.probe_bounced.tobytes()


def test_what_went_and_what_came(scene: BakedScene) -> None:
    """Without the chest the place under the spot light is bright; with another it is dark."""
    gone = Change(id=2, before=HERE.matrix(), after=None)
    came = Change(id=9, before=None, after=THERE.matrix(), came=(CHEST, (1.0, 1.0, 1.0)))
    got = relit(scene, [gone, came], FINE, threads=2)
    assert 2 not in got.charts
    texels = {
        name: scene.places[
            (np.abs(scene.positions[:, 2]) < 1e-3)
            & (np.abs(scene.positions[:, :2] - pose.position_m[:2]) < 0.2).all(axis=1)
            & (scene.owners == 1)
        ]
        for name, pose in (("here", HERE), ("there", THERE))
    }
    lamp = got.layers[1].direct.reshape(-1)
    assert (lamp[texels["there"]] == 0.0).all()
    offset = np.array(LAMP.position_m) - (HERE.position_m[0], HERE.position_m[1], 0.0)
    d2 = (offset**2).sum()
    expected = (1 - (d2 / 400.0) ** 2) ** 2 * offset[2] / d2**1.5 / np.pi
    np.testing.assert_allclose(lamp[texels["here"]].mean(dtype=float), expected, rtol=0.05)


def test_a_thing_moved_before_a_panel_gets_all_its_light(scene: BakedScene) -> None:
    """A centimetre away all that is seen is the panel: irradiance over pi is its radiance.

    Samples alone found a hundredth of it, or many times too much.
    """
    at = np.asarray(PANEL.position_m) + np.array([0.5 + 0.01, 0.0, 0.0])
    pose = Pose((float(at[0]), float(at[1]), float(at[2])))
    change = Change(id=2, before=HERE.matrix(), after=pose.matrix())
    got = relit(scene, [change], FINE, threads=2)
    assert got.layers[2].light == PANEL
    facing = (scene.owners == 2) & (scene.normals[:, 0] < -0.9)
    direct = got.layers[2].direct.reshape(-1)[scene.places[facing]]
    assert direct.size > 10
    np.testing.assert_allclose(direct.astype(float), 1.0, atol=0.05)


BLUE = Thing(hollow((6.0, 6.0, 3.0), base_colour=(0.15, 0.35, 0.7, 1.0)), ROOM.pose)


@pytest.mark.parametrize(("quality", "most"), [(QUICK, 0.12), (FINE, 0.08)])
def test_a_painted_room_is_lit_as_if_baked_so(
    scene: BakedScene, quality: Quality, most: float
) -> None:
    """Another colour of the walls colours what bounces, on the walls and on the chest."""
    snapshot = still([BLUE, Thing(CHEST, HERE)], lights=LIGHTS, environment=Environment())
    expected = bake(snapshot, settings=FINER)
    got = relit(scene, [], quality, threads=2, painted={1: BLUE.model})
    assert got.charts == scene.baked.charts
    for instance in (1, 2):
        for number, layer in enumerate(expected.layers):
            mine, wanted, before = (
                read(light, instance, snapshot, light.layers[number].bounced)[1]
                for light in (got, expected, scene.baked)
            )
            assert layer.light == got.layers[number].light
            mine, wanted, before = (np.asarray(a).mean(axis=0) for a in (mine, wanted, before))
            changed = np.abs(before - wanted).mean()
            if instance == 1:
                assert np.abs(mine - wanted).mean() <= most * wanted.mean() + 5e-4
            assert np.abs(mine - wanted).mean() <= 0.4 * changed


def test_paint_gives_the_same_bytes_on_any_number_of_threads(scene: BakedScene) -> None:
    """As moves do."""
    one, two = (
        relit(scene, [], QUICK, threads=threads, painted={1: BLUE.model}) for threads in (1, 2)
    )
    for a, b in zip(one.layers, two.layers, strict=True):
        np.testing.assert_array_equal(a.bounced, b.bounced)
        np.testing.assert_array_equal(a.probe_bounced, b.probe_bounced)


def test_a_quick_answer_has_no_stains(scene: BakedScene) -> None:
    """Where the chest stood, single texels differ little from the finished light."""
    at = scene.places[within(scene.positions, 0.6)]
    quick, fine = (
        np.sum([layer.bounced.reshape(-1, 3)[at].astype(float) for layer in light.layers], axis=0)
        for light in (moved(scene, QUICK), moved(scene, FINE))
    )
    assert len(at) > 50
    assert np.sqrt(((quick - fine) ** 2).mean()) < 0.06 * fine.mean()
