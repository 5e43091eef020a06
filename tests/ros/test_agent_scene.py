"""An Agent's requests about objects, lights and scenarios, by the original client's names."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sailenv_ros import Agent
from sailenv_ros.errors import AssetError, InvalidRequest, SailenvError, UnknownName
from tests.support.upload_files import box_zip

pytestmark = pytest.mark.ros

NAMESPACE = "/furnished"


@pytest.fixture
def agent(keeper: Agent) -> Agent:
    """The agent, in the scene as it begins, at its origin and level."""
    keeper.change_scene("optical")
    keeper.set_follow(False)
    keeper.set_position((0.0, 0.0, 1.0), teleport=True)
    keeper.set_rotation((0.0, 0.0, 0.0), teleport=True)
    return keeper


def test_an_id_is_the_value_of_pixels(agent: Agent) -> None:
    """The spawned object is in the next frame under its id, name and category; then it is gone."""
    id_ = agent.spawn_object("Cube", (1.5, 0.0, 1.0), object_name="box", category="chair")
    instance = agent.instances[id_]
    assert (instance.name, instance.category, instance.static) == ("box", "chair", True)
    frame = agent.get_frame()
    seen = frame["instance"] == id_
    assert seen[60, 80]
    assert set(np.unique(frame["category"][seen])) == {instance.category_id}
    agent.despawn_object("box")
    assert id_ not in agent.instances
    assert not (agent.get_frame()["instance"] == id_).any()


def test_the_originals_call_means_the_same(agent: Agent) -> None:
    """Positional arguments, ids as decimal texts, rotations in degrees, dynamics removed or not."""
    stays = agent.spawn_object("Cube", (0, 0, 20), (0, 0, 90), True, (1, 2, 1), True)
    falls = agent.spawn_object("Cube", (5, 0, 20), (0, 0, 0), False, (1, 1, 1), False)
    agent.step(24)
    assert agent.get_object(stays).pose.position_m == (0.0, 0.0, 20.0)
    assert agent.get_object(stays).pose.rpy_deg == pytest.approx((0, 0, 90))
    assert agent.get_object(stays).scale == (1.0, 2.0, 1.0)
    assert agent.get_object(falls).pose.position_m[2] < 20.0
    agent.despawn_object(str(falls))
    assert falls not in agent.instances


def test_a_moved_object_is_motion(agent: Agent) -> None:
    """Its pixels flow; those of a teleported one have no past; its rotation is kept."""
    id_ = agent.spawn_object("Cube", (2.0, 0.0, 1.0), (0, 0, 30))
    agent.get_frame()
    for teleport in (False, True):
        agent.step(8)
        agent.move_object(id_, (2.0, 0.02 if teleport else 0.01, 1.0), teleport=teleport)
        frame = agent.get_frame()
        seen = frame["instance"] == id_
        assert frame["flow_valid"][seen].any() != teleport
        assert (np.abs(frame["flow"][seen]).max() > 1.0) != teleport
    assert agent.get_object(id_).pose.rpy_deg == pytest.approx((0, 0, 30))
    agent.move_object(id_, (2.0, 0.0, 1.0), (0, 0, 45))
    assert agent.get_object(id_).pose.rpy_deg == pytest.approx((0, 0, 45))


def test_behaviours_and_masses_make_objects_move(agent: Agent) -> None:
    """What has a behaviour is not static, and turns as it was told."""
    turning = {"type": "rotate_rigidbody", "angular_velocity": np.array([0.0, 0.0, 90.0])}
    id_ = agent.spawn_object("cube", (0, 0, 30), behaviours=[turning])
    assert agent.instances[id_].moving
    agent.step(24)
    state = agent.get_object(id_)
    assert state.angular_velocity[2] == pytest.approx(np.pi / 2, rel=1e-3)
    assert dict(state.behaviours[0])["angular_velocity"] == [0.0, 0.0, 90.0]


def test_behaviours_come_and_go(agent: Agent) -> None:
    """An object turns once it is told to, and says so until it is told no more."""
    id_ = agent.spawn_object("cube", (0, 0, 30), remove_dynamics=False)
    agent.add_behaviour(id_, {"type": "rotate_rigidbody", "angular_velocity": [0, 0, 90]})
    agent.step(24)
    state = agent.get_object(id_)
    assert state.angular_velocity[2] == pytest.approx(np.pi / 2, rel=1e-3)
    assert [behaviour["type"] for behaviour in state.behaviours] == ["rotate_rigidbody"]
    agent.remove_behaviours(id_)
    assert agent.get_object(id_).behaviours == ()
    with pytest.raises(InvalidRequest, match="behaviour"):
        agent.add_behaviour(id_, {"type": "spin"})


def test_a_scenario_comes_from_text_file_and_mapping(agent: Agent, tmp_path: Path) -> None:
    """All three give the ids of its objects, in order."""
    mapping = {"scene": "object_view", "objects": [{"asset": "cube", "name": "a"}]}
    text = "scene: object_view\nobjects:\n  - {asset: cube, name: a}\n"
    file = tmp_path / "scenario.yaml"
    file.write_text(text)
    for scenario in (mapping, text, file):
        (id_,) = agent.load_scenario(scenario)
        assert agent.scene == "object_view"
        assert agent.instances[id_].name == "a"


def test_lights_are_set_and_read_by_the_originals_names(agent: Agent) -> None:
    """Colours go through 0 to 255 and come back as they were set, numbers and vectors too."""
    name = agent.lights_names[0]
    agent.set_light_color(name, 255, 128, 0)
    agent.set_light_intensity(name, 0.5)
    agent.set_light_indirect_multiplier(name, 2.0)
    agent.set_light_position(name, (1.0, 2.0, 3.0))
    agent.set_light_direction(name, (0.0, 0.0, -7.0))
    assert agent.get_light_color(name) == (255, 128, 0)
    assert agent.get_light_intensity(name) == 0.5
    assert agent.get_light_indirect_multiplier(name) == 2.0
    assert agent.get_light_position(name) == (1.0, 2.0, 3.0)
    assert agent.get_light_direction(name) == (0.0, 0.0, -1.0)
    assert agent.get_light_type(name) == "directional"
    agent.set_light_type(name, "spot")
    spot = agent.set_light(name, inner_cone_deg=40.0, outer_cone_deg=50.0)
    assert (spot.type, spot.inner_cone_deg, spot.outer_cone_deg) == ("spot", 40.0, 50.0)
    assert agent.set_light(name, inner_cone_deg=45.0) == agent.get_light(name)


def test_light_and_background_are_seen(agent: Agent) -> None:
    """A brighter ambient light makes the picture brighter; the background has its colour."""
    before = agent.get_frame()
    agent.set_ambient_light_color(255, 255, 255)
    assert agent.get_ambient_light_color() == (255, 255, 255)
    agent.set_rotation((0.0, -60.0, 0.0))
    agent.change_main_camera_clear_flags(0, 0, 255)
    sky = agent.get_frame()
    empty = sky["instance"] == 0
    blue, green, red = (np.median(sky["main"][empty][:, c]) for c in range(3))
    assert blue > 100
    assert max(green, red) < blue / 2
    agent.change_main_camera_clear_flags(-1, 0, 0)
    assert np.median(agent.get_frame()["main"][empty][:, 1]) > green + 20
    agent.set_rotation((0.0, 0.0, 0.0))
    after = agent.get_frame()
    there = (before["instance"] > 0) & (after["instance"] == before["instance"])
    assert after["main"][there].mean() > before["main"][there].mean() + 5


@pytest.mark.parametrize(
    ("ask", "error", "words"),
    [
        (lambda a: a.spawn_object("Cubee"), InvalidRequest, "did you mean 'Cube'"),
        (lambda a: a.spawn_object(3), InvalidRequest, "name must be a text"),
        (lambda a: a.spawn_object("cube", "here"), InvalidRequest, "position must be three"),
        (lambda a: a.spawn_object("cube", scale=0), InvalidRequest, "from 0.001 to 1000"),
        (lambda a: a.spawn_object("cube", scale=-1), InvalidRequest, "scale"),
        (lambda a: a.spawn_object("cube", mass_kg="heavy"), InvalidRequest, "must be a number"),
        (lambda a: a.spawn_object("cube", behaviours=["spin"]), InvalidRequest, "its type and"),
        (lambda a: a.despawn_object(60000), InvalidRequest, "instance id must be"),
        (lambda a: a.despawn_object(0), InvalidRequest, "instance id must be the id of an object"),
        (lambda a: a.despawn_object("nothing"), UnknownName, "object must be one of"),
        (lambda a: a.get_object(1.5), InvalidRequest, "an instance id, or the name"),
        (lambda a: a.get_object(True), InvalidRequest, "an instance id, or the name"),
        (lambda a: a.move_object(1, (1e9, 0, 0)), InvalidRequest, "position must be"),
        (lambda a: a.load_scenario({"objects": [{}]}), InvalidRequest, "asset"),
        (lambda a: a.load_scenario(Path("/none")), InvalidRequest, "scenario must be a file"),
        (lambda a: a.get_light("moon"), InvalidRequest, "light must be one of: sun"),
        (lambda a: a.set_light("sun", power=1), UnknownName, "attribute of a light"),
        (lambda a: a.set_light("sun", intensity=-1), InvalidRequest, "from 0 to"),
        (lambda a: a.set_light_color("sun", 256, 0, 0), InvalidRequest, "from 0 to 255"),
        (lambda a: a.set_light_color("sun", 0.5, 0, 0), InvalidRequest, "from 0 to 255"),
        (lambda a: a.set_background("sea"), UnknownName, "one of: sky, colour"),
    ],
)
def test_refusals_say_what_is_accepted(
    agent: Agent, ask: Any, error: type[SailenvError], words: str
) -> None:
    """Each in one sentence, and the scene is as it was."""
    instances, lights = agent.instances, [agent.get_light(name) for name in agent.lights_names]
    with pytest.raises(error, match=words):
        ask(agent)
    assert agent.instances == instances
    assert [agent.get_light(name) for name in agent.lights_names] == lights


def test_an_uploaded_model_is_seen(agent: Agent, tmp_path: Path) -> None:
    """A zip goes to the simulator; its model is spawned by the name given, and is in the image."""
    file = tmp_path / "old crate.zip"
    file.write_bytes(box_zip())
    name = agent.send_obj_zip(str(file), category="chair", height_m=0.5)
    assert name in agent.spawnable_objects_names
    id_ = agent.spawn_object(name, (1.5, 0.0, 0.75))
    frame = agent.get_frame()
    seen = frame["instance"] == id_
    assert seen[60, 80]
    assert agent.instances[id_].category == "chair"
    blue, green, red = frame["main"][60, 80].tolist()
    assert red > 2 * max(blue, green)
    with file.open("rb") as opened:
        again = agent.send_obj_zip(opened, "old crate.zip", category="chair", height_m=0.5)
    assert again == f"{name}_2"
    with file.open("rb") as opened, pytest.raises(InvalidRequest, match="with its filename"):
        agent.send_obj_zip(opened)
    with pytest.raises(InvalidRequest, match="one that can be read"):
        agent.send_obj_zip(tmp_path / "none.zip")
    with pytest.raises(AssetError, match="zip"):
        agent.send_obj_zip(io.BytesIO(b"no zip at all"), "a.zip")
