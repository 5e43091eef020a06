"""When light is brought up to date, and which light a snapshot gets."""

from __future__ import annotations

import threading
from concurrent.futures import CancelledError
from dataclasses import replace

import numpy as np
import pytest

from sailenv_ros.light.bake.pipeline import bake
from sailenv_ros.light.relight import relighter as module
from sailenv_ros.light.relight.object_lights import ObjectLights
from sailenv_ros.light.relight.quality import FINE, QUICK
from sailenv_ros.light.relight.relighter import READY_FRAMES, Relighter
from sailenv_ros.light.relight.relighting import relit
from sailenv_ros.types.baked_light import BakedLight
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Light
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.support.bake_scenes import COARSE, ground, still
from tests.support.tiny_scenes import Thing, box_mesh, model_of

FLOOR = Thing(ground(4.0))
BOX = model_of(box_mesh(0.5))
CUP = model_of(box_mesh(0.1))
LAMP = Light(name="lamp", type="point", position_m=(0.0, 0.0, 2.0))
HOME = Pose((0.5, 0.0, 0.251))
SECOND_NS = 1_000_000_000


@pytest.fixture(scope="module")
def baked() -> WorldSnapshot:
    """A box on a floor, with its light."""
    snapshot = still([FLOOR, Thing(BOX, HOME)], lights=(LAMP,))
    light = bake(snapshot, settings=COARSE)
    return replace(snapshot, contents=replace(snapshot.contents, baked=light))


@pytest.fixture
def worked(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The qualities of what was worked out, in order."""
    done: list[str] = []

    def counted(scene: object, changes: object, quality: object, **kwargs: int) -> BakedLight:
        done.append({QUICK: "quick", FINE: "fine"}[quality])  # type: ignore[index]
        return relit(scene, changes, quality, **kwargs)  # type: ignore[arg-type]

    monkeypatch.setattr(module, "relit", counted)
    return done


def at(snapshot: WorldSnapshot, x: float, time_ns: int = 0) -> WorldSnapshot:
    """The box at another place."""
    poses = snapshot.world_from_body.copy()
    poses[1, 0, 3] = x
    return replace(snapshot, world_from_body=poses, sim_time_ns=time_ns)


def light_of(snapshot: WorldSnapshot) -> BakedLight:
    """Its baked light."""
    assert snapshot.contents.baked is not None
    return snapshot.contents.baked


def test_where_nothing_moves_nothing_is_done(baked: WorldSnapshot, worked: list[str]) -> None:
    """The very snapshot comes back."""
    assert Relighter().lit(baked, wanted=True, lockstep=True) is baked
    assert worked == []


def test_a_move_changes_the_light_of_its_own_frame(baked: WorldSnapshot, worked: list[str]) -> None:
    """What was baked for the box counts at its new place; frames without a picture do no work."""
    relighter = Relighter()
    relighter.lit(baked, wanted=True, lockstep=True)
    moved = at(baked, -0.5)
    assert relighter.lit(moved, wanted=False, lockstep=True) is moved
    got = relighter.lit(moved, wanted=True, lockstep=True)
    assert worked == ["quick"]
    assert np.array_equal(light_of(got).charts[2].world_from_body, moved.world_from_body[1])
    again = relighter.lit(moved, wanted=True, lockstep=True)
    assert again.contents is got.contents
    assert worked == ["quick"]


def test_in_lockstep_light_is_refined_after_simulated_time(
    baked: WorldSnapshot, worked: list[str]
) -> None:
    """Half a second after the last move, in one frame, whatever the wall clock says."""
    relighter = Relighter()
    for time_ns in (0, SECOND_NS // 4, SECOND_NS, 2 * SECOND_NS):
        relighter.lit(at(baked, -0.5, time_ns), wanted=True, lockstep=True)
    assert worked == ["quick", "fine"]


def test_what_moved_between_two_frames_counts_too(baked: WorldSnapshot, worked: list[str]) -> None:
    """Away and back in no picture: light is that of whoever has seen it, rough until it rests."""
    relighter = Relighter()
    for time_s, changed_s in ((1.0, 0.0), (2.1, 2.0), (2.4, 2.0), (2.6, 2.0)):
        relighter.lit(
            at(baked, -0.5, round(time_s * SECOND_NS)),
            wanted=True,
            lockstep=True,
            changed_ns=round(changed_s * SECOND_NS),
        )
    assert worked == ["fine", "quick", "fine"]


def test_in_real_time_light_is_refined_beside(baked: WorldSnapshot, worked: list[str]) -> None:
    """On another thread; the frame after its end shows it."""
    relighter = Relighter()
    first = relighter.lit(at(baked, -0.5), wanted=True, lockstep=False)
    relighter.lit(at(baked, -0.5), wanted=True, lockstep=False)
    assert relighter._refining is not None
    relighter._refining[1].result(timeout=60.0)
    last = relighter.lit(at(baked, -0.5), wanted=True, lockstep=False)
    assert worked == ["quick", "fine"]
    assert light_of(last) is not light_of(first)
    relighter.close()


def test_what_moves_on_casts_no_stale_shadow(baked: WorldSnapshot, worked: list[str]) -> None:
    """In real time it is lit from its second step on as what can move is; at rest, baked in."""
    relighter = Relighter()
    relighter.lit(baked, wanted=True, lockstep=False)
    lit = [
        relighter.lit(at(baked, 0.5 - 0.1 * step, step), wanted=True, lockstep=False)
        for step in range(1, 6)
    ]
    assert [2 in light_of(snapshot).charts for snapshot in lit] == [True] + 4 * [False]
    assert worked.count("quick") == 2
    for step in range(6, 12):
        rest = relighter.lit(at(baked, 0.0, step), wanted=True, lockstep=False)
    assert worked.count("quick") == 3
    assert 2 in light_of(rest).charts
    relighter.close()


def test_in_lockstep_every_frame_is_right(baked: WorldSnapshot, worked: list[str]) -> None:
    """Of furniture that is moved before each capture, every picture has its light."""
    relighter = Relighter()
    for x in (0.2, -0.2, -0.5):
        got = relighter.lit(at(baked, x), wanted=True, lockstep=True)
        assert 2 in light_of(got).charts
    assert worked == ["quick", "quick", "quick"]


def test_back_home_it_is_what_was_baked(baked: WorldSnapshot) -> None:
    """Light that was worked out is a function of what stands where, and of nothing else."""
    relighter = Relighter()
    relighter.lit(at(baked, -0.5), wanted=True, lockstep=True)
    back = replace(baked, sim_time_ns=5)
    assert relighter.lit(back, wanted=True, lockstep=True) is back


def test_what_goes_leaves_no_shadow(baked: WorldSnapshot) -> None:
    """The floor under it is lit; another bake begins anew."""
    relighter = Relighter()
    relighter.watch(baked)
    contents = baked.contents
    left = baked.of_rows(np.arange(1))
    got = light_of(relighter.lit(left, wanted=True, lockstep=True))
    lamp = got.layers[1].direct
    assert (lamp > 0).sum() > (light_of(baked).layers[1].direct > 0).sum()
    unbaked = replace(baked, contents=replace(contents, baked=None))
    assert relighter.lit(unbaked, wanted=True, lockstep=True) is unbaked


@pytest.mark.parametrize(("lockstep", "frames"), [(False, 2), (True, READY_FRAMES + 1)])
def test_the_first_move_finds_all_ready(baked: WorldSnapshot, lockstep: bool, frames: int) -> None:
    """What relighting needs is made beside frames that move nothing, and is what a frame makes."""
    relighter, other = Relighter(), Relighter()
    for _ in range(frames):
        assert relighter._preparing is None
        relighter.lit(baked, wanted=True, lockstep=lockstep)
    assert relighter._preparing is not None
    relighter._preparing.result(timeout_s=60.0)
    first = light_of(relighter.lit(at(baked, -0.5), wanted=True, lockstep=lockstep))
    other.watch(baked)
    second = light_of(other.lit(at(baked, -0.5), wanted=True, lockstep=True))
    for one, two in zip(first.layers, second.layers, strict=True):
        assert np.array_equal(one.direct, two.direct)
        assert np.array_equal(one.bounced, two.bounced)
    relighter.close()


def test_alone_nothing_is_prepared_beside_the_frames(baked: WorldSnapshot) -> None:
    """A room of which only the camera moves costs nothing; the light of a move is the same."""
    relighter, other = Relighter(), Relighter()
    relighter.beforehand = False
    for _ in range(READY_FRAMES + 2):
        for one in (relighter, other):
            one.lit(baked, wanted=True, lockstep=True)
    assert relighter._preparing is None
    assert relighter._pool is None
    pairs = [
        light_of(one.lit(at(baked, -0.5), wanted=True, lockstep=True)).layers
        for one in (relighter, other)
    ]
    for one, two in zip(*pairs, strict=True):
        assert np.array_equal(one.direct, two.direct)
        assert np.array_equal(one.bounced, two.bounced)
    other.close()


@pytest.fixture(scope="module")
def with_a_cup(baked: WorldSnapshot) -> WorldSnapshot:
    """The same, and a small box that can move."""
    whole = still([FLOOR, Thing(BOX, HOME), Thing(CUP, Pose((-0.5, 0.0, 0.06)))], lights=(LAMP,))
    *others, cup = whole.contents.instances
    moving = (*others, replace(cup, instance=replace(cup.instance, static=False)))
    contents = replace(whole.contents, instances=moving, baked=light_of(baked))
    return replace(whole, contents=contents)


def test_in_lockstep_the_first_picture_has_the_light_on_what_can_move(
    with_a_cup: WorldSnapshot,
) -> None:
    """Frames without a picture do no work; while nothing changes the mapping is the same."""
    relighter = Relighter()
    assert relighter.lit(with_a_cup, wanted=False, lockstep=True) is with_a_cup
    first = relighter.lit(with_a_cup, wanted=True, lockstep=True)
    assert first.object_light.keys() == {3}
    again = relighter.lit(replace(with_a_cup, sim_time_ns=5), wanted=True, lockstep=True)
    assert again.object_light is first.object_light
    assert again.contents is first.contents


def test_furniture_beside_it_changes_the_light_on_what_can_move(with_a_cup: WorldSnapshot) -> None:
    """A box that was put between lamp and cup takes its light."""
    relighter = Relighter()
    open_ = relighter.lit(with_a_cup, wanted=True, lockstep=True).object_light[3]
    poses = with_a_cup.world_from_body.copy()
    poses[1, :3, 3] = -0.5, 0.0, 1.0
    between = replace(with_a_cup, world_from_body=poses)
    shaded = relighter.lit(between, wanted=True, lockstep=True).object_light[3]
    assert np.abs(open_.direct[1]).max() > 0.0
    assert np.abs(shaded.direct[1]).max() == 0.0


def test_what_is_prepared_for_a_move_ends_with_the_scene(
    with_a_cup: WorldSnapshot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """After the step that it is at: a simulation that ends does not work on for seconds."""
    began, may_go_on = threading.Event(), threading.Event()

    def slowly(*args: object, **settings: object) -> None:
        began.set()
        assert may_go_on.wait(60.0)

    monkeypatch.setattr(ObjectLights, "update", slowly)
    relighter = Relighter()
    for _ in range(2):
        relighter.lit(with_a_cup, wanted=True, lockstep=False)
    preparing = relighter._preparing
    assert preparing is not None
    assert began.wait(60.0)
    relighter.watch(replace(with_a_cup, contents=replace(with_a_cup.contents, baked=None)))
    may_go_on.set()
    with pytest.raises(CancelledError):
        preparing.result(timeout_s=60.0)
    relighter.close()


def test_in_real_time_no_picture_waits_for_the_light_on_what_can_move(
    with_a_cup: WorldSnapshot,
) -> None:
    """It is worked out beside, and shown when it is there."""
    relighter = Relighter()
    assert not relighter.lit(with_a_cup, wanted=True, lockstep=False).object_light
    relighter.lit(with_a_cup, wanted=True, lockstep=False)
    assert relighter._preparing is not None
    relighter._preparing.result(timeout_s=60.0)
    assert relighter.lit(with_a_cup, wanted=True, lockstep=False).object_light.keys() == {3}
    relighter.close()
