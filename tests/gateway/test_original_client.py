"""The SAILenv client of PyPI, unmodified, against a running simulator: all that it can ask."""

from __future__ import annotations

import inspect
import threading
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from sailenv_ros.frame.pictures.colours import grey_depth
from sailenv_ros.gateway import GatewayServer
from sailenv_ros.simulation import Simulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.labels import colour_instances
from sailenv_ros.types.views import FIVE_VIEWS
from tests.support.sailenv_client import OriginalAgent, clients_of, original_client
from tests.support.upload_files import box_zip
from tests.support.waiting import until

pytestmark = pytest.mark.gl

WIDTH, HEIGHT = 128, 96


@pytest.fixture(scope="module")
def gateway(lockstep: Simulation) -> Iterator[GatewayServer]:
    with GatewayServer(lockstep, port=0) as server:
        yield server


@pytest.fixture(params=[False, True], ids=["raw", "gzip"])
def client(request: pytest.FixtureRequest, gateway: GatewayServer) -> Iterator[Any]:
    settings = {"width": WIDTH, "height": HEIGHT, "use_gzip": request.param}
    with original_client(gateway.port, **settings) as agent:
        agent.change_scene("optical/scene")
        yield agent


@pytest.fixture
def quiet(capsys: pytest.CaptureFixture[str]) -> Iterator[None]:
    """The client prints whatever it is refused: nothing of that here."""
    yield
    assert capsys.readouterr().out == ""


def test_these_are_all_its_methods() -> None:
    """Nothing that the client can do is left out of the tests below."""
    public = {
        name
        for name, member in vars(OriginalAgent).items()
        if inspect.isfunction(member) and not name.startswith("_")
    }
    lights = {"color", "position", "direction", "intensity", "indirect_multiplier"}
    assert public == {
        "register",
        "delete",
        "get_frame",
        "receive_bytes",
        "receive_next_frame_view",
        "change_scene",
        "get_categories",
        "get_position",
        "set_position",
        "get_rotation",
        "set_rotation",
        "toggle_follow",
        "spawn_object",
        "despawn_object",
        "send_obj_zip",
        "change_main_camera_clear_flags",
        "get_light_type",
        "get_ambient_light_color",
        "set_ambient_light_color",
        *(f"{verb}_light_{what}" for verb in ("get", "set") for what in lights),
    }


@pytest.mark.usefixtures("quiet")
@pytest.mark.parametrize("use_gzip", [False, True], ids=["raw", "gzip"])
def test_frames_are_the_simulators_pixel_for_pixel(
    lockstep: Simulation, gateway: GatewayServer, use_gzip: bool
) -> None:
    """Every view of the same stamp, as a direct capture has it; sizes are those of the wire."""
    intrinsics = CameraIntrinsics(width=WIDTH, height=HEIGHT)
    lockstep.change_scene("optical")
    lockstep.register_agent(AgentSpec(name="direct", intrinsics=intrinsics, rate_hz=0.0))
    try:
        with original_client(
            gateway.port, width=WIDTH, height=HEIGHT, use_gzip=use_gzip
        ) as agent:  # fmt: skip
            first = agent.get_frame()
            lockstep.capture(agent="direct")
            assert first["deltaTime"] == 0.0
            lockstep.step(12)
            ours, theirs = lockstep.capture(FIVE_VIEWS, agent="direct"), agent.get_frame()
    finally:
        lockstep.delete_agent("direct")
    assert theirs["deltaTime"] == pytest.approx(0.05)
    np.testing.assert_array_equal(np.rint(theirs["main"] * 255), ours["rgb"])
    np.testing.assert_array_equal(theirs["category"], ours["category"])
    np.testing.assert_array_equal(
        np.rint(theirs["object"] * 255), colour_instances(ours["instance"])
    )
    grey = grey_depth(ours["depth"], near_m=intrinsics.near_m, range_m=10.0)
    np.testing.assert_array_equal(np.rint(theirs["depth"] * 255), grey)
    flow = np.nan_to_num(ours["flow"], nan=0.0)
    assert np.abs(flow).max() > 1.0
    np.testing.assert_array_equal(theirs["flow"][..., 0], flow[..., 0])
    np.testing.assert_array_equal(theirs["flow"][..., 1], -flow[..., 1])
    raw = WIDTH * HEIGHT * 8
    assert theirs["sizes"]["flow"] < raw if use_gzip else theirs["sizes"]["flow"] == raw


@pytest.mark.usefixtures("quiet")
def test_only_the_views_asked_for_are_rendered(gateway: GatewayServer) -> None:
    """What is switched off is not there, what is on is in its place."""
    switches = ("main", "object", "category", "flow", "depth")
    for wanted in (("main", "flow"), ("depth",), ("category", "object"), ()):
        settings = {f"{name}_frame_active": name in wanted for name in switches}
        with original_client(gateway.port, width=32, height=24, **settings) as agent:
            frame = agent.get_frame()
            assert {name for name in switches if frame[name] is not None} == set(wanted)
            assert all(frame[name].shape[:2] == (24, 32) for name in wanted)


@pytest.mark.usefixtures("quiet")
def test_clients_are_agents_of_their_own(lockstep: Simulation, gateway: GatewayServer) -> None:
    """Several at once, each with its size, from several threads; they go when they say so."""
    wrong: list[str] = []

    def look(number: int) -> None:
        size = (32 + 8 * number, 24 + number)
        settings = {"width": size[0], "height": size[1], "use_gzip": bool(number % 2)}
        with original_client(gateway.port, **settings) as agent:
            for _ in range(5):
                shape = agent.get_frame()["main"].shape
                if shape != (size[1], size[0], 3):
                    wrong.append(f"{number}: {shape}")

    threads = [threading.Thread(target=look, args=(number,)) for number in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60.0)
    assert not wrong
    until(lambda: not clients_of(lockstep), "the agents to be gone", 10.0)


@pytest.mark.usefixtures("quiet")
def test_scenes_bring_categories_spawnables_and_lights(lockstep: Simulation, client: Any) -> None:
    """After a change of scene the client knows names as the public scripts use them."""
    assert "optical/scene" in client.scenes
    client.change_scene("solid_benchmark/scene")
    assert lockstep.info.scene == "solid_benchmark"
    assert client.lights_names == ["sun"]
    assert client.categories[8] == "chair"
    assert client.get_categories() == {n: c.name for n, c in lockstep.info.categories.items()}
    assert {"Cube", "Cylinder"} <= set(client.spawnable_objects_names)


def test_an_unknown_scene_is_told_in_words(
    lockstep: Simulation, client: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    """The client prints the sentence; the scene stays as it was, and so does the conversation."""
    client.change_scene("room_99/scene")
    assert "did you mean 'room_0" in capsys.readouterr().out
    assert lockstep.info.scene == "optical"
    assert len(client.get_position()) == 3


@pytest.mark.usefixtures("quiet")
def test_poses_are_unitys(lockstep: Simulation, client: Any) -> None:
    """What is set is read back, and is where Unity's axes say in ours."""
    client.toggle_follow()
    agent = clients_of(lockstep)[0]
    client.set_position((1.0, 2.0, 3.0))
    client.set_rotation((10.0, 200.0, 30.0))
    assert client.get_position() == pytest.approx((1.0, 2.0, 3.0))
    assert client.get_rotation() == pytest.approx((10.0, 200.0, 30.0), abs=1e-3)
    assert lockstep.get_pose(agent=agent).position_m == pytest.approx((3.0, -1.0, 2.0))
    client.set_rotation((0.0, 90.0, 0.0))
    ahead = lockstep.get_pose(agent=agent).matrix()[:3, 0]
    np.testing.assert_allclose(ahead, (0.0, -1.0, 0.0), atol=1e-6)


@pytest.mark.usefixtures("quiet")
def test_an_agent_follows_the_mover_until_it_is_told_not_to(
    lockstep: Simulation, client: Any
) -> None:
    """As SAILenv's agents do: they move along the scene's waypoints by default."""
    began = client.get_position()
    lockstep.step(240)
    there = client.get_position()
    assert there != began
    client.toggle_follow()
    lockstep.step(240)
    assert client.get_position() == pytest.approx(there)
    client.toggle_follow()
    assert client.get_position() != pytest.approx(there)


@pytest.mark.usefixtures("quiet")
def test_objects_come_and_go(lockstep: Simulation, client: Any) -> None:
    """An object stands where it was put, has its own colour in the object view, and goes again."""
    client.toggle_follow()
    client.set_position((0.0, 1.0, -4.0))
    client.set_rotation((0.0, 0.0, 0.0))
    settings = {"position": (0.0, 1.0, -2.5), "rotation": (0.0, 30.0, 0.0)}
    idstr = client.spawn_object("Cube", **settings, scale=(0.5, 1.0, 2.0))
    state = lockstep.get_object(int(idstr))
    assert (state.asset, state.static, state.scale) == ("cube", True, (2.0, 0.5, 1.0))
    expected = Pose.from_rpy_deg((-2.5, 0.0, 1.0), (0.0, 0.0, -30.0))
    np.testing.assert_allclose(state.pose.matrix(), expected.matrix(), atol=1e-6)
    colour = colour_instances(np.array([int(idstr)], np.uint16))[0]
    assert _pixels_of(client, colour) > 100
    client.despawn_object(idstr)
    assert _pixels_of(client, colour) == 0
    assert client.spawned_objects_idstr_names_table == {}
    falling = client.spawn_object("Sphere", position=(0.0, 5.0, 2.0), remove_dynamics=False)
    height = lockstep.get_object(int(falling)).pose.position_m[2]
    lockstep.step(120)
    assert lockstep.get_object(int(falling)).pose.position_m[2] < height - 1.0


def test_what_cannot_be_spawned_is_refused(
    client: Any, capsys: pytest.CaptureFixture[str], caplog: pytest.LogCaptureFixture
) -> None:
    """The client gets an empty id, the terminal the reason; unknown ids are refused in words."""
    assert client.spawn_object("Chiar 01") == ""
    assert client.spawn_object("Cube", scale=(0.0, 1.0, 1.0)) == ""
    client.despawn_object("65000")
    out = capsys.readouterr().out
    assert out.count("not spawned") == 2
    assert "Error despawning object with id 65000" in out
    assert "'Chiar 01' was not spawned" in caplog.text


@pytest.mark.usefixtures("quiet")
def test_a_model_of_ones_own_can_be_sent_and_spawned(
    lockstep: Simulation, client: Any, tmp_path: Any
) -> None:
    """A zip with an obj, as a file and as an open one; the answer is what spawns it."""
    path = tmp_path / "My Thing.zip"
    path.write_bytes(box_zip())
    for answer in (client.send_obj_zip(str(path)), _sent_open(client, path)):
        idstr = client.spawn_object(answer)
        assert lockstep.get_object(int(idstr)).asset == answer


def test_a_broken_model_is_refused_in_words(client: Any) -> None:
    """What comes back in place of the name says what is wrong."""
    import io

    answer = client.send_obj_zip(io.BytesIO(b"no zip at all"), filename="thing.zip")
    assert answer.startswith("error: ")
    assert len(client.get_position()) == 3


@pytest.mark.usefixtures("quiet")
def test_lights_can_be_read_and_changed(lockstep: Simulation, client: Any) -> None:
    """Each property of a light there and back; directions and positions by Unity's axes."""
    sun = client.lights_names[0]
    assert client.get_light_type(sun) == "directional"
    client.set_light_color(sun, 10, 128, 255)
    assert client.get_light_color(sun) == (10, 128, 255)
    client.set_light_intensity(sun, 0.75)
    assert client.get_light_intensity(sun) == 0.75
    client.set_light_indirect_multiplier(sun, 0.25)
    assert client.get_light_indirect_multiplier(sun) == 0.25
    client.set_light_position(sun, (1.0, 2.0, 3.0))
    assert client.get_light_position(sun) == (1.0, 2.0, 3.0)
    client.set_light_direction(sun, (0.0, -2.0, 0.0))
    assert client.get_light_direction(sun) == (0.0, -1.0, 0.0)
    light = lockstep.lights[0]
    assert light.direction == pytest.approx((0.0, 0.0, -1.0))
    assert light.position_m == pytest.approx((3.0, -1.0, 2.0))


def test_an_unknown_light_is_told_so(client: Any, capsys: pytest.CaptureFixture[str]) -> None:
    """Every getter gives None and every setter prints; the conversation goes on."""
    for what in ("color", "intensity", "indirect_multiplier", "position", "direction", "type"):
        assert getattr(client, f"get_light_{what}")("moon") is None
    client.set_light_color("moon", 1, 2, 3)
    client.set_light_color(client.lights_names[0], 256, 0, 0)
    assert capsys.readouterr().out.count("Error") == 8
    assert client.get_light_type(client.lights_names[0]) == "directional"


@pytest.mark.usefixtures("quiet")
def test_surroundings_can_be_changed(lockstep: Simulation, client: Any) -> None:
    """Ambient light there and back; the background is a colour, then the sky again."""
    client.set_ambient_light_color(50, 60, 70)
    assert client.get_ambient_light_color() == (50, 60, 70)
    client.change_main_camera_clear_flags(255, 0, 0)
    assert lockstep.info.environment.background == "colour"
    assert lockstep.info.environment.background_colour == pytest.approx((1.0, 0.0, 0.0))
    client.change_main_camera_clear_flags(-1, 0, 0)
    assert lockstep.info.environment.background == "sky"


def _pixels_of(client: Any, colour: np.ndarray) -> int:
    seen = np.rint(client.get_frame()["object"] * 255) == colour
    return int(seen.all(axis=-1).sum())


def _sent_open(client: Any, path: Any) -> str:
    with path.open("rb") as file:
        answer: str = client.send_obj_zip(file, filename=path.name)
    return answer
