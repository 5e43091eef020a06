"""Objects, surroundings and tracks that an editor changes: ids, flow, refusals, announcements."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sailenv_ros.errors import InvalidEntry, InvalidRequest, NameTaken, UnknownName
from sailenv_ros.simulation.synchronous import SynchronousSimulation
from sailenv_ros.types.baked_light import BakedLight, LightChart, ProbeGrid, Unwrapping
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.scene_info import SceneInfo
from tests.support.lockstep_core import lockstep_core

ROOM = """
version: 1
room: {size: [4, 4, 3], openings: [{type: window, wall: north, curtains: true}]}
objects:
  - {name: table, asset: cube, position: [0, 0, 0.25], scale: [1, 1, 0.5], static: true}
  - {name: cup, asset: cube, on: table, scale: 0.1}
  - {name: toy, asset: sphere, position: [1, 1, 1], scale: 0.2, gravity: false,
     behaviours: [{type: rotate_rigidbody, angular_velocity: [0, 0, 45]}]}
mover:
  total_time: 8
  waypoints:
    - {position: [-1, 0, 1]}
    - {position: [1, 0, 1]}
    - {position: [1, 1, 1]}
    - {position: [-1, 1, 1]}
"""


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[SynchronousSimulation]:
    folder: Path = tmp_path_factory.mktemp("scenes")
    (folder / "den.yaml").write_text(ROOM, encoding="utf-8")
    core = lockstep_core("den", folder)
    yield core
    core.close()


@pytest.fixture
def core(shared: SynchronousSimulation) -> SynchronousSimulation:
    shared.reset()
    return shared


@pytest.fixture
def told(core: SynchronousSimulation) -> Iterator[list[SceneInfo]]:
    infos: list[SceneInfo] = []
    core.on_info = infos.append
    yield infos
    core.on_info = lambda info: None


def row(core: SynchronousSimulation, obj: str) -> int:
    names = [drawn.instance.name for drawn in core.world.contents.instances]
    return names.index(obj)


def history(core: SynchronousSimulation, obj: str) -> int:
    return int(core.world.snapshot().histories[row(core, obj)])


# -- objects -----------------------------------------------------------------------------------


def test_a_changed_object_keeps_its_id_and_its_place(
    core: SynchronousSimulation, told: list[SceneInfo]
) -> None:
    """All that it was not asked to change stays; clients are told at once, the order is kept."""
    ids = [drawn.instance.id for drawn in core.world.contents.instances]
    before = core.get_object("toy")
    core.change_object(
        before.id,
        name="ball",
        category="chair",
        scale=0.4,
        mass=2.0,
        friction=0.25,
        colour="#ff0000",
    )
    after = core.get_object(before.id)
    assert [drawn.instance.id for drawn in core.world.contents.instances] == ids
    assert (after.id, after.name, after.category) == (before.id, "ball", "chair")
    assert after.pose == before.pose
    assert after.scale == (0.4, 0.4, 0.4)
    assert after.mass_kg == 2.0
    assert after.behaviours == before.behaviours
    assert {i.name for i in told[-1].instances if i.id == before.id} == {"ball"}
    assert told[-1].revision >= core.world.contents.revision
    looks = core.world.body(before.id).placement.asset.model.parts[0].material
    assert looks.base_colour[:3] == (1.0, 0.0, 0.0)


def test_another_scale_cuts_the_past_off(core: SynchronousSimulation) -> None:
    """A point of a surface that has another size has no place of before: no flow there."""
    before = history(core, "toy"), history(core, "cup")
    core.change_object("toy", category="chair")
    assert (history(core, "toy"), history(core, "cup")) == before
    core.change_object("toy", scale=0.3)
    assert history(core, "toy") not in before
    assert history(core, "cup") == before[1]


def test_another_scale_takes_the_baked_light_off(core: SynchronousSimulation) -> None:
    """Light was baked for a surface of another size; that of the others stays."""
    table, floor = core.world.find("table"), core.world.find("floor")
    chart = LightChart(
        unwrapping=Unwrapping(vertices=(), triangles=(), uvs=()),
        offset=(0.0, 0.0),
        scale=(1.0, 1.0),
        world_from_body=np.eye(4),
    )
    probes = ProbeGrid(origin_m=(0.0, 0.0, 0.0), spacing_m=(1.0, 1.0, 1.0), shape=(1, 1, 1))
    charts = {table: chart, floor: chart}
    core.world.set_baked(BakedLight(fingerprint="x", charts=charts, layers=(), probes=probes))
    core.change_object("table", colour="#123456")
    assert set(core.world.contents.baked.charts) == {table, floor}
    core.change_object("table", scale=0.5)
    assert set(core.world.contents.baked.charts) == {floor}


def test_a_changed_object_goes_on_as_it_moved(core: SynchronousSimulation) -> None:
    """Velocity and behaviours survive; a behaviour's time goes on."""
    core.step(24)
    before = core.get_object("toy")
    core.change_object("toy", roughness=0.1)
    after = core.get_object("toy")
    assert after.angular_velocity == pytest.approx(before.angular_velocity)
    assert before.angular_velocity[2] == pytest.approx(math.radians(45.0), rel=1e-3)
    core.step(24)
    turned = core.get_object("toy").pose.rpy_deg[2] - after.pose.rpy_deg[2]
    assert turned == pytest.approx(4.5, abs=0.05)


def test_a_mass_is_the_asset_s_again_when_it_is_left_out(core: SynchronousSimulation) -> None:
    """None takes the asset's own, scaled by the volume."""
    own_kg = core.get_object("cup").mass_kg
    core.change_object("cup", mass=5.0)
    core.change_object("cup", mass=None, scale=0.2)
    assert core.get_object("cup").mass_kg == pytest.approx(8.0 * own_kg)


@pytest.mark.parametrize(
    ("obj", "changes", "error", "words"),
    [
        ("cup", {"name": "toy"}, NameTaken, "'toy'"),
        ("cup", {"name": "north wall"}, NameTaken, "'north wall'"),
        ("cup", {"category": "spaceship"}, InvalidEntry, "spaceship"),
        ("cup", {"scale": 0.0}, InvalidEntry, "0.001 to 1000"),
        ("cup", {"position": [0, 0, 0]}, UnknownName, "position"),
        ("toy", {"static": True}, InvalidRequest, "behaviours"),
        ("toy", {"scale": (0.1, 0.2, 0.1)}, InvalidEntry, "ball"),
        ("floor", {"scale": 2.0}, InvalidRequest, "parts of the room"),
        ("nothing", {"scale": 2.0}, UnknownName, "nothing"),
    ],
)
def test_a_refused_change_changes_nothing(
    core: SynchronousSimulation,
    told: list[SceneInfo],
    obj: str,
    changes: dict[str, Any],
    error: type[Exception],
    words: str,
) -> None:
    contents, snapshot = core.world.contents, core.world.snapshot()
    with pytest.raises(error, match=words):
        core.change_object(obj, **changes)
    assert core.world.contents is contents
    assert core.world.snapshot() is snapshot
    assert not told


@pytest.mark.parametrize("how", ["despawn", "move", "shrink"])
def test_what_slept_upon_an_object_falls_when_it_goes(
    core: SynchronousSimulation, how: str
) -> None:
    """Nothing hangs in the air because the engine had put it to sleep."""
    core.step(960)
    asleep = core.get_object("cup").pose
    core.step(24)
    assert core.get_object("cup").pose == asleep
    if how == "despawn":
        core.despawn_object("table")
    elif how == "move":
        core.move_object("table", pose=Pose((0.0, 1.3, 0.25)))
    else:
        core.change_object("table", scale=0.1)
    core.step(120)
    # The small table is still 0.3 m high in its middle.
    assert core.get_object("cup").pose.position_m[2] == pytest.approx(
        0.35 if how == "shrink" else 0.05, abs=0.005
    )


def test_what_nothing_collides_with_can_go_too(core: SynchronousSimulation) -> None:
    """Curtains have no collision shape: there is nothing that they could wake."""
    core.despawn_object("curtains 1")
    assert "curtains 1" not in {i.name for i in core.info.instances}


# -- surroundings ------------------------------------------------------------------------------


def test_surroundings_change_by_the_keys_of_a_scene_file(
    core: SynchronousSimulation, told: list[SceneInfo]
) -> None:
    """Those that are not named stay, also what `set_background` has set since the start."""
    core.set_background("colour", (0.1, 0.2, 0.3))
    core.set_environment(exposure=1.5, sky_share=0.25, ambient="#ffffff")
    environment = told[-1].environment
    assert (environment.exposure, environment.sky_share) == (1.5, 0.25)
    assert environment.ambient == (1.0, 1.0, 1.0)
    assert (environment.background, environment.background_colour) == ("colour", (0.1, 0.2, 0.3))


@pytest.mark.parametrize(
    ("changes", "error", "words"),
    [
        ({"exposure": "bright"}, InvalidEntry, r"environment.exposure must be a number"),
        ({"sky_map": "atlantis"}, InvalidEntry, "atlantis"),
        ({"fog": 1.0}, UnknownName, "exposure"),
    ],
)
def test_refused_surroundings_change_nothing(
    core: SynchronousSimulation, changes: dict[str, Any], error: type[Exception], words: str
) -> None:
    before = core.info.environment
    with pytest.raises(error, match=words):
        core.set_environment(**changes)
    assert core.info.environment == before


# -- lights ------------------------------------------------------------------------------------


def test_lights_come_and_go(core: SynchronousSimulation, told: list[SceneInfo]) -> None:
    """A new one is announced as it was asked for, and is saved."""
    lamp = core.add_light("lamp", "point", position_m=(0.0, 0.0, 2.0), intensity=3.0)
    assert told[-1].lights == (lamp,)
    assert (lamp.position_m, lamp.intensity, lamp.range_m) == ((0.0, 0.0, 2.0), 3.0, 20.0)
    assert "{name: lamp, type: point, position: [0, 0, 2], intensity: 3}" in core.scene_text()
    core.remove_light("lamp")
    assert told[-1].lights == ()
    assert "lights:" not in core.scene_text()


@pytest.mark.parametrize(
    ("name", "type_", "attributes", "error"),
    [
        ("lamp", "point", {}, "name"),
        ("torch", "laser", {}, "laser"),
        ("", "point", {}, "name"),
        ("torch", "point", {"range_m": 0.0}, "range"),
        ("torch", "point", {"glow": 1.0}, "glow"),
    ],
)
def test_a_light_that_cannot_be_saved_is_refused(
    core: SynchronousSimulation, name: str, type_: Any, attributes: dict[str, Any], error: str
) -> None:
    core.add_light("lamp", "spot")
    before = core.lights
    with pytest.raises(InvalidRequest, match=error):
        core.add_light(name, type_, **attributes)
    with pytest.raises(UnknownName, match="lamp"):
        core.remove_light("torch")
    assert core.lights == before


# -- tracks ------------------------------------------------------------------------------------


def test_waypoints_are_told_and_driven_through(
    core: SynchronousSimulation, told: list[SceneInfo]
) -> None:
    """A new track of two legs in 4 s is run through from its beginning; scene_info has it."""
    track = [Pose((0.0, 0.0, 1.0)), Pose((1.0, 0.0, 1.0))]
    core.set_waypoints(track, total_time_s=4.0)
    (mover,) = told[-1].movers
    assert (mover.waypoints, mover.total_time_s, mover.loop) == (tuple(track), 4.0, True)
    core.step(240)
    assert core.get_mover_pose().position_m == pytest.approx((0.5, 0.0, 1.0))


def test_a_waypoint_more_leaves_the_mover_where_it_is(core: SynchronousSimulation) -> None:
    """On its second leg it is as far on it as before; only the way home is another."""
    core.step(3 * 240)
    here = core.get_mover_pose()
    assert here.position_m == pytest.approx((1.0, 0.5, 1.0))
    core.set_waypoints([Pose((-1.0, 2.0, 1.0))], append=True)
    assert core.get_mover_pose().position_m == pytest.approx(here.position_m, abs=1e-6)
    assert len(core.info.movers[0].waypoints) == 5


def test_without_waypoints_it_stays_where_it_is(core: SynchronousSimulation) -> None:
    """And waypoints that come later are run through in the time that was set before."""
    core.step(240)
    here = core.get_mover_pose()
    core.set_waypoints([])
    core.step(240)
    assert core.get_mover_pose() == here
    core.set_waypoints([here, Pose((0.0, 0.0, 2.0))])
    assert core.info.movers[0].total_time_s == 8.0
    assert core.get_mover_pose() == here


def test_a_driven_mover_is_not_moved_by_a_new_track(core: SynchronousSimulation) -> None:
    """Only once the waypoints are given control it goes there."""
    core.set_mover_controller("rigidbody")
    here = core.get_mover_pose()
    core.set_waypoints([Pose((0.0, 0.0, 2.0))])
    assert core.get_mover_pose() == here
    core.set_mover_controller("waypoint")
    assert core.get_mover_pose() == Pose((0.0, 0.0, 2.0))


def test_an_open_track_that_grows_is_gone_on_with(core: SynchronousSimulation) -> None:
    """At its end it waits, and leaves for a waypoint that is added."""
    core.set_waypoints([Pose((0.0, 0.0, 1.0)), Pose((1.0, 0.0, 1.0))], total_time_s=1.0, loop=False)
    core.step(480)
    assert core.get_mover_pose().position_m == pytest.approx((1.0, 0.0, 1.0))
    core.set_waypoints([Pose((1.0, 1.0, 1.0))], append=True)
    assert core.get_mover_pose().position_m == pytest.approx((1.0, 0.0, 1.0), abs=1e-6)
    core.step(60)  # half of a leg of 0.5 s
    assert core.get_mover_pose().position_m == pytest.approx((1.0, 0.5, 1.0), abs=1e-6)


@pytest.mark.parametrize(
    ("given", "error"),
    [
        ({"waypoints": [(0, 0, 0)]}, "Pose"),
        ({"waypoints": Pose()}, "a list"),
        ({"waypoints": [Pose()] * 1001}, "at most 1000"),
        ({"waypoints": [Pose()] * 997, "append": True}, "at most 1000"),
        ({"waypoints": [], "total_time_s": 0.0}, "above 0"),
        ({"waypoints": [], "total_time_s": "long"}, "a number"),
        ({"waypoints": [], "mover": "bus"}, "bus"),
    ],
)
def test_a_refused_track_changes_nothing(
    core: SynchronousSimulation, told: list[SceneInfo], given: dict[str, Any], error: str
) -> None:
    with pytest.raises(InvalidRequest, match=error):
        core.set_waypoints(**given)
    assert not told
    assert len(core.info.movers[0].waypoints) == 4
