"""A running world that is saved, checked and loaded again is the same world."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, example, given, settings
from hypothesis import strategies as st

from sailenv_ros.cli.main import main
from sailenv_ros.errors import InvalidEntry, InvalidRequest, UnknownName
from sailenv_ros.scene.serialisation import light_entry
from sailenv_ros.simulation.models.uploads import asset_from_upload
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.simulation.synchronous import SynchronousSimulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from tests.support.lockstep_core import lockstep_core
from tests.support.upload_files import box_zip

EXAMPLES = 30

STUDIO = """
version: 1
title: A studio
gravity: [0, 0, -5]
environment: {ambient: "#202020", exposure: 0.5}
categories: [{name: drone, id: 201, colour: "#112233"}]
lights:
  - {name: sun, type: directional, direction: [-1, 2, -3], colour: "#fff0d8"}
  - {name: lamp, type: spot, position: [0, 0, 2.5], inner_cone: 10, outer_cone: 30}
room:
  size: [5, 4, 3]
  floor: oak_planks
  ceiling: false
  openings: [{type: window, wall: north, curtains: true}]
objects:
  - {name: table, asset: cube, position: [0, 0, 0.25], scale: [1, 1, 0.5], static: true}
  - {name: cup, asset: cylinder, on: table, position: [0.1, 0.2, 0], scale: 0.1, colour: "#ff8800"}
  - {name: shelf, asset: cube, wall: west, at: 1.2, scale: 0.3, static: true}
  - {name: toy, asset: sphere, position: [1, 1, 1], scale: 0.2, gravity: false, category: drone,
     behaviours: [{type: rotate_rigidbody, angular_velocity: [0, 0, 45]}]}
movers:
  - name: rail
    total_time: 8
    waypoints: [{position: [-1, 0, 1.5], look_at: [0, 0, 1]}, {position: [-1, 1, 1.5]}]
  - {name: cart, position: [1, -1, 1.5], rotation: [0, 0, 90], controller: rigidbody}
agents:
  - {name: watcher, width: 32, height: 24, following: false, position: [-1.9, 0, 1.5]}
  - {name: rider, width: 16, height: 12, mover: cart}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("scenes")
    (folder / "studio.yaml").write_text(STUDIO, encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def shared(folder: Path) -> Iterator[SynchronousSimulation]:
    made = lockstep_core("studio", folder)
    yield made
    made.close()


@pytest.fixture
def core(shared: SynchronousSimulation) -> SynchronousSimulation:
    begin(shared, "studio")
    return shared


def begin(core: SynchronousSimulation, scene: str) -> None:
    """Begin a scene with its own agents alone, as a simulator that has just started does."""
    for agent in core.info.agents:
        core.delete_agent(agent.name)
    core.change_scene(scene)


def told(core: SynchronousSimulation) -> dict[str, Any]:
    """All that a scene file may say, as the world has it, but for poses."""
    world, info = core.world, core.info
    objects = {}
    for body in world.bodies:
        state = core.get_object(body.placement.name)
        looks = [part.material for part in body.placement.asset.model.parts]
        objects[state.name] = (
            state.asset,
            state.category,
            state.scale,
            state.static,
            round(state.mass_kg, 9),
            [dict(behaviour) for behaviour in state.behaviours],
            (body.placement.friction, body.placement.restitution, body.placement.gravity),
            [(look.base_colour, look.metallic, look.roughness) for look in looks],
        )
    return {
        "objects": objects,
        "lights": [{**light_entry(light), "direction": None} for light in info.lights],
        "environment": info.environment,
        "categories": list(info.categories.values()),
        "movers": [(m.name, m.controller, m.total_time_s, m.loop) for m in info.movers],
        "agents": {
            agent.name: (
                agent.intrinsics,
                agent.views,
                agent.following,
                agent.mover,
                agent.rate_hz,
                agent.depth_range_m,
                agent.picture,
            )
            for agent in info.agents
        },
        "gravity": world.described.gravity if world.described else None,
    }


def poses(core: SynchronousSimulation) -> dict[str, Pose]:
    """Poses of objects, waypoints, movers that are not led, and agents that do not follow."""
    found = {
        # Told by the point that it looks at: straight down, every heading is the same.
        f"light {light.name}": Pose(light.direction)
        for light in core.info.lights
        if light.type != "point"
    }
    found |= {f"object {body.placement.name}": body.pose() for body in core.world.bodies}
    for mover in core.info.movers:
        for place, pose in enumerate(mover.waypoints):
            found[f"waypoint {mover.name} {place}"] = pose
        if mover.controller == "rigidbody" or not mover.waypoints:
            found[f"mover {mover.name}"] = core.get_mover_pose(mover.name)
    for agent in core.info.agents:
        if not agent.following:
            found[f"agent {agent.name}"] = core.get_pose(agent=agent.name)
    return found


def assert_same_poses(first: dict[str, Pose], second: dict[str, Pose]) -> None:
    assert first.keys() == second.keys()
    for name, pose in first.items():
        away_m = math.dist(pose.position_m, second[name].position_m)
        turned = abs(float(np.dot(pose.orientation_xyzw, second[name].orientation_xyzw)))
        assert away_m < 2e-6, name
        assert turned > 1.0 - 1e-12, name


def assert_comes_back(core: SynchronousSimulation) -> str:
    """Save, begin what was saved, and compare; return the text."""
    contents, places = told(core), poses(core)
    text = Path(core.save_scene("again", overwrite=True)).read_text(encoding="utf-8")
    begin(core, "again")
    assert told(core) == contents, text
    assert_same_poses(places, poses(core))
    return text


# -- what was not changed ----------------------------------------------------------------------


def test_an_untouched_scene_keeps_the_words_of_its_file(core: SynchronousSimulation) -> None:
    """Walls, carriers, factors, colours, points that are faced come back as they were."""
    text = core.scene_text()
    for words in (
        "ambient: '#202020'",
        "floor: oak_planks",
        "ceiling: false",
        "{name: cup, asset: cylinder, on: table, position: [0.1, 0.2, 0], scale: 0.1",
        "{name: shelf, asset: cube, wall: west, at: 1.2, scale: 0.3, static: true}",
        "{position: [-1, 0, 1.5], look_at: [0, 0, 1]}",
        "colour: '#ff8800'",
    ):
        assert words in text


def test_what_has_only_settled_still_stands_upon_its_carrier(core: SynchronousSimulation) -> None:
    """A cup drops by the millimetre that it was placed above the table; it stays `on` it."""
    core.set_gravity((0.0, 0.0, -9.81))  # wakes what sleeps from the start
    core.step(240)
    assert core.get_object("cup").pose.position_m[2] < 0.5 + 0.05 + 0.0009
    assert "on: table" in core.scene_text()


def test_what_stands_upon_what_has_settled_comes_back(folder: Path) -> None:
    """A label that hangs over a book keeps its place when the book drops onto a turned table."""
    (folder / "piled.yaml").write_text(
        """
version: 1
objects:
  - {name: table, asset: cube, position: [0, 0, 0.25], rotation: [0, 0, 30], scale: [1, 1, 0.5],
     static: true}
  - {name: book, asset: cube, on: table, level: [0.2, 0.3], position: [0.1, 0.2, 0],
     rotation: [0, 0, 10], scale: [0.2, 0.3, 0.05]}
  - {name: label, asset: cube, on: book, position: [0.07, 0, 0.01], scale: 0.02, static: true}
""",
        encoding="utf-8",
    )
    core = lockstep_core("studio", folder)
    begin(core, "piled")
    before = core.get_object("book").pose
    for body in core.world.bodies:
        body.wake()
    core.step(24)
    assert core.get_object("book").pose.position_m[2] < before.position_m[2] - 0.0009
    text = assert_comes_back(core)
    assert "on: table" in text
    assert "level: [0.2, 0.3]" in text
    assert "on: book" in text
    core.close()


def test_a_saved_scene_passes_the_check_and_says_the_same_again(
    core: SynchronousSimulation, capsys: pytest.CaptureFixture[str]
) -> None:
    """`sailenv scene check` has nothing to say, and saving what was loaded changes no letter."""
    core.step(30)
    core.move_object("table", pose=Pose.from_rpy_deg((0.4, 0.1, 0.25), (0.0, 0.0, 31.7)))
    path = Path(core.save_scene("checked", overwrite=True))
    assert main(["scene", "check", str(path)]) == 0
    capsys.readouterr()
    core.change_scene("checked")
    assert core.scene_text() == path.read_text(encoding="utf-8")


# -- what was changed --------------------------------------------------------------------------

_numbers = st.floats(-1.9, 1.9, allow_nan=False)
_angles = st.floats(-180.0, 180.0, allow_nan=False)
_poses = st.builds(
    lambda xyz, rpy: Pose.from_rpy_deg(xyz, rpy),
    st.tuples(_numbers, _numbers, st.floats(0.1, 2.5)),
    st.tuples(_angles, st.sampled_from([0.0, 90.0, -90.0, 12.345678]) | _angles, _angles),
)
_colours = st.tuples(*[st.floats(0.0, 1.0)] * 3)
_names = st.sampled_from(["table", "cup", "shelf", "toy"])
_changes = st.fixed_dictionaries(
    {},
    optional={
        "scale": st.sampled_from([0.1, 0.25, 0.5]),
        "category": st.sampled_from(["chair", "drone", None]),
        "colour": _colours | st.none(),
        "mass": st.floats(0.01, 10.0) | st.none(),
        "friction": st.floats(0.0, 2.0),
        "roughness": st.floats(0.0, 1.0),
        "gravity": st.booleans(),
    },
)
_lights = st.fixed_dictionaries(
    {},
    optional={
        "type": st.sampled_from(["directional", "point", "spot", "area"]),
        "intensity": st.floats(0.0, 10.0),
        "colour": _colours,
        "direction": st.tuples(_numbers, _numbers, st.just(-1.0)),
        "indirect_multiplier": st.floats(0.0, 3.0),
    },
)
_surroundings = st.fixed_dictionaries(
    {},
    optional={
        "exposure": st.floats(-3.0, 3.0),
        "sky_zenith": _colours,
        "sky_share": st.floats(0.0, 1.0),
        "background": st.sampled_from(["sky", "colour"]),
    },
)
# Far away and beside any vertical: a micrometre of an eye turns it by less than is compared.
_faced = st.sampled_from(
    [(None, None), (None, (30.0, -40.0, 20.0)), ("cup", (40.0, 50.0, 60.0)),
     ("table", (40.0, 50.0, 60.0))]
)  # fmt: skip
_edits = st.one_of(
    st.tuples(st.just("spawn_object"), st.sampled_from(["cube", "Sphere"]), _poses, st.booleans()),
    st.tuples(st.just("move_object"), _names, _poses),
    st.tuples(st.just("change_object"), _names, _changes),
    st.tuples(st.just("despawn_object"), _names),
    st.tuples(st.just("add_behaviour"), st.sampled_from(["cup", "toy"]), _numbers),
    st.tuples(st.just("remove_behaviours"), _names),
    st.tuples(st.just("set_light"), st.sampled_from(["sun", "lamp"]), _lights),
    st.tuples(st.just("add_light"), st.sampled_from(["moon", "glow"]), _lights),
    st.tuples(st.just("remove_light"), st.sampled_from(["sun", "lamp", "moon"])),
    st.tuples(st.just("set_environment"), _surroundings),
    st.tuples(st.just("set_ambient_light"), _colours),
    st.tuples(st.just("set_waypoints"), st.sampled_from(["rail", "cart"]),
              st.lists(_poses, max_size=3), st.booleans()),
    st.tuples(st.just("set_mover_controller"), st.sampled_from(["rail", "cart"]),
              st.sampled_from(["waypoint", "rigidbody"])),
    st.tuples(st.just("set_pose"), st.sampled_from(["watcher", "rider"]), _poses),
    st.tuples(st.just("set_follow"), st.sampled_from(["watcher", "rider"]), st.booleans()),
    st.tuples(st.just("set_look_at"), st.sampled_from(["watcher", "rider"]), _faced),
    st.tuples(st.just("set_mover_look_at"), st.sampled_from(["rail", "cart"]), _faced),
    st.tuples(st.just("step"), st.integers(1, 12)),
)  # fmt: skip


def edit(core: SynchronousSimulation, name: str, *given: Any) -> None:
    """Ask for one edit as its request wants it."""
    if name == "spawn_object":
        asset, pose, static = given
        core.spawn_object(asset, pose=pose, scale=0.2, remove_dynamics=static)
    elif name in ("change_object", "set_light"):
        getattr(core, name)(given[0], **given[1])
    elif name == "add_light":
        attributes = {"type": "point", **given[1]}
        core.add_light(given[0], attributes.pop("type"), **attributes)
    elif name == "set_environment":
        core.set_environment(**given[0])
    elif name == "add_behaviour":
        core.add_behaviour(
            given[0], {"type": "rotate_rigidbody", **{"angular_velocity": [given[1], 0.0, 1.0]}}
        )
    elif name == "set_waypoints":
        core.set_waypoints(given[1], mover=given[0], append=given[2], total_time_s=5.0)
    elif name == "set_mover_controller":
        core.set_mover_controller(given[1], given[0])
    elif name == "move_object":
        core.move_object(given[0], pose=given[1])
    elif name == "set_look_at":
        core.set_look_at(*given[1], agent=given[0])
    elif name == "set_mover_look_at":
        core.set_mover_look_at(*given[1], mover=given[0])
    elif name in ("set_pose", "set_follow"):
        getattr(core, name)(given[1], agent=given[0])
    else:
        getattr(core, name)(*given)


@settings(
    max_examples=EXAMPLES,
    # Smaller edits need not fail alike, and looking for them takes minutes.
    phases=[Phase.explicit, Phase.reuse, Phase.generate],
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
@example(edits=[("add_behaviour", "cup", 0.0), ("step", 12)])  # it drops onto the table
@given(edits=st.lists(_edits, max_size=8))
def test_an_edited_world_comes_back_as_it_was(
    core: SynchronousSimulation, edits: list[Any]
) -> None:
    """Whatever was edited, in whatever order: contents are equal, poses to a micrometre."""
    begin(core, "studio")
    for name, *given_ in edits:
        try:
            edit(core, name, *given_)
        except InvalidRequest:
            continue  # the object has gone, or is static: nothing was changed
    assert_comes_back(core)
    begin(core, "studio")


def test_waypoints_lights_and_objects_that_are_new_are_in_the_file(
    core: SynchronousSimulation,
) -> None:
    """Each of the edits of an editor, by its words in the file."""
    core.spawn_object(
        "Sphere", pose=Pose.from_rpy_deg((1, 0.5, 1), (0, 0, 30)), remove_dynamics=True
    )
    core.change_object("table", scale=(1, 2, 0.5), category="couch", name="desk", colour="#00ff00")
    core.set_light("lamp", intensity=0.25)
    core.set_waypoints([Pose((0.5, 0.5, 1.25))], mover="rail", append=True)
    core.add_behaviour("cup", {"type": "poltergeist"})
    text = assert_comes_back(core)
    for words in (
        "{name: sphere_1, asset: Sphere, position: [1, 0.5, 1], rotation: [0, 0, 30], static:",
        "name: desk",
        "scale: [1, 2, 0.5]",
        "category: couch",
        "colour: '#00ff00'",
        "{name: lamp, type: spot, position: [0, 0, 2.5], intensity: 0.25, inner_cone: 10, "
        "outer_cone: 30}",
        "- {position: [0.5, 0.5, 1.25]}",
        "behaviours: [{type: poltergeist}]",
    ):
        assert words in text
    assert "on: table" not in text  # its carrier was made larger, and stays where it is


def test_what_stands_upon_something_that_went_keeps_its_place(core: SynchronousSimulation) -> None:
    """Neither a carrier that was taken away, nor another that came by its name, carries it."""
    place = core.get_object("cup").pose
    core.despawn_object("table")
    core.spawn_object(
        "cube", object_name="table", pose=Pose((1.5, -1.0, 0.5)), remove_dynamics=True
    )
    assert "on: table" not in assert_comes_back(core)
    assert core.get_object("cup").pose.position_m == pytest.approx(place.position_m, abs=1e-6)


def test_what_flies_goes_on_flying(core: SynchronousSimulation) -> None:
    """Speeds are saved: [m/s] along, and [deg/s] about, the world's axes."""
    core.spawn_object(
        "cube", object_name="stone", pose=Pose((0.0, 0.0, 2.0)), scale=0.1, remove_dynamics=False
    )
    core.step(60)
    before = core.get_object("stone")
    assert_comes_back(core)
    after = core.get_object("stone")
    assert after.linear_velocity == pytest.approx(before.linear_velocity, abs=1e-6)
    assert before.linear_velocity[2] == pytest.approx(-5.0 * 60 / 240, rel=0.01)


def test_objects_of_a_scenario_are_saved_too(core: SynchronousSimulation) -> None:
    """What came on top of the scene is a part of what is saved."""
    core.load_scenario({"objects": [{"asset": "cube", "name": "guest", "position": [1, 1, 1]}]})
    assert "name: guest" in assert_comes_back(core)


def test_pictures_are_saved_as_they_are(core: SynchronousSimulation) -> None:
    """Settings that were changed at run time are in the file, and in the scene that it begins."""
    changed = core.set_picture(exposure=-0.5, tone_curve="linear", agent="watcher")
    assert "tone_curve: linear" in assert_comes_back(core)
    assert core.get_picture(agent="watcher") == changed


def test_agents_of_clients_are_saved_where_they_are_named(core: SynchronousSimulation) -> None:
    """The scene's own are saved as they are now; those of clients come and go with them."""
    lens = CameraIntrinsics(width=64, height=48, vertical_fov_deg=75.0)
    core.register_agent(AgentSpec(name="visitor", intrinsics=lens, following=False))
    core.set_pose(Pose((1.0, 1.0, 1.0)), agent="visitor")
    core.delete_agent("rider")
    assert "visitor" not in core.scene_text()
    path = core.save_scene("seen", overwrite=True, cameras=["visitor"])
    begin(core, "seen")
    assert {agent.name for agent in core.info.agents} == {"watcher", "visitor"}
    assert core.get_pose(agent="visitor") == Pose((1.0, 1.0, 1.0))
    assert core.capture(["depth"], agent="visitor").camera.intrinsics == lens
    assert "vertical_fov: 75" in Path(path).read_text(encoding="utf-8")
    with pytest.raises(UnknownName, match="nobody"):
        core.scene_text(cameras=["nobody"])


# -- what cannot be saved ----------------------------------------------------------------------


def test_parts_of_the_room_that_were_moved_are_told(core: SynchronousSimulation) -> None:
    """A file describes the room as a whole; nothing is left out silently."""
    core.despawn_object("window 1")
    core.move_object("north wall", pose=Pose((0.0, 1.0, 0.0)))
    with pytest.raises(InvalidEntry, match=r"'window 1' .*taken out.*'north wall' .*moved"):
        core.save_scene("broken")
    assert "broken" not in core.info.scenes


def test_parts_that_a_room_may_do_without_are_left_out(core: SynchronousSimulation) -> None:
    """A room whose skirting and curtains were taken out begins without them."""
    core.despawn_object("skirting")
    core.despawn_object("curtains 1")
    text = assert_comes_back(core)
    assert "skirting: false" in text
    assert "curtains: false" in text


def test_an_uploaded_model_is_kept_or_told(
    core: SynchronousSimulation, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No file can name a model that this simulator alone has; in one's own pack it can."""
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    asset = asset_from_upload(box_zip(), name="my_box", filename="box.zip", category="chair")
    core.spawn_object(
        core.editor.add_model(asset, rename=False),
        pose=Pose((1.0, 0.0, 1.0)),
        remove_dynamics=False,
    )
    with pytest.raises(InvalidRequest, match=r"keep_models .*'my_box'"):
        core.save_scene("boxed")
    path = core.save_scene("boxed", keep_models=True)
    library = SceneLibrary()
    assert "my_box" in library.spawnables
    assert "my_box" in {entry.asset for entry in library.load(Path(path)).objects}
    core.save_scene("boxed", overwrite=True)  # it is kept already


@pytest.mark.parametrize(
    "name",
    ["", ".", "..", "../out", "a/b", "/etc/passwd", ".hidden", "x.yaml", "a\0b", "a" * 64, 7],
)
def test_names_that_lead_elsewhere_are_refused(
    core: SynchronousSimulation, folder: Path, name: Any
) -> None:
    before = sorted(folder.rglob("*"))
    with pytest.raises(InvalidRequest, match="scene name must be letters, digits"):
        core.save_scene(name)
    assert sorted(folder.rglob("*")) == before


def test_a_file_is_replaced_only_where_that_is_asked_for(
    core: SynchronousSimulation, folder: Path
) -> None:
    """A name in use is refused and its file stays as it is; so is a name of another folder's."""
    path = Path(core.save_scene("mine", title="The first"))
    first = path.read_text(encoding="utf-8")
    assert path == folder / "mine.yaml"
    assert "mine" in core.info.scenes
    with pytest.raises(InvalidRequest, match="'mine'"):
        core.save_scene("mine", title="The second")
    assert path.read_text(encoding="utf-8") == first
    core.save_scene("mine", title="The second", overwrite=True)
    assert "title: The second" in path.read_text(encoding="utf-8")
    with pytest.raises(InvalidRequest, match=r"optical\.yaml, which would be hidden"):
        core.save_scene("optical", overwrite=True)
    assert {p.name for p in folder.iterdir() if p.suffix != ".yaml"} <= {".lock"}


def test_a_link_is_replaced_and_not_followed(core: SynchronousSimulation, folder: Path) -> None:
    """A link in the folder leads nowhere: what it points to is not written."""
    target = folder.parent / "precious.txt"
    target.write_text("precious", encoding="utf-8")
    (folder / "linked.yaml").symlink_to(target)
    core.save_scene("linked", overwrite=True)
    assert target.read_text(encoding="utf-8") == "precious"
    assert not (folder / "linked.yaml").is_symlink()
