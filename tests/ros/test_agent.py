"""The Agent over real DDS: what it gives is the simulator's truth, and each failure is told."""

from __future__ import annotations

import copy
import math
import os
import pickle
import signal
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from sailenv_ros import Agent
from sailenv_ros.errors import (
    InvalidRequest,
    InvalidState,
    SimulationClosed,
    SimulatorLost,
    UnknownName,
    WrongProcess,
)
from sailenv_ros.system.presence import simulator_is_present
from sailenv_ros.types.geometry import Pose, look_at
from tests.ros.conftest import LOCKSTEP, SMALL
from tests.support.waiting import until

pytestmark = pytest.mark.ros

NAMESPACE = "/tested"


def domain() -> int:
    """Return the ROS domain that the tests run in."""
    return int(os.environ["ROS_DOMAIN_ID"])


# -- frames --------------------------------------------------------------------------------


def test_a_frame_has_the_promised_entries(agent: Agent) -> None:
    """Names, shapes and types are those of the interface, and every array is writable."""
    agent.step(8)
    frame = agent.get_frame()
    shown = {
        name: (value.shape, value.dtype.name)
        for name, value in frame.items()
        if isinstance(value, np.ndarray)
    }
    assert shown == {
        "main": ((120, 160, 3), "uint8"),
        "depth": ((120, 160, 1), "uint8"),
        "depth_m": ((120, 160), "float32"),
        "category": ((120, 160), "uint8"),
        "instance": ((120, 160), "uint16"),
        "object": ((120, 160, 3), "uint8"),
        "flow": ((120, 160, 2), "float32"),
        "flow_valid": ((120, 160), "bool"),
        "K": ((3, 3), "float64"),
        "world_from_camera": ((4, 4), "float64"),
    }
    assert frame["scene"] == "optical"
    assert frame["sizes"] == {
        "main": 57600,
        "depth": 76800,
        "category": 19200,
        "object": 38400,
        "flow": 153600,
    }
    for value in frame.values():
        if isinstance(value, np.ndarray):
            value[...] = 0


def test_frames_share_nothing(agent: Agent) -> None:
    """A frame is its caller's own: the next one leaves it as it was."""
    first = agent.get_frame()
    kept = {name: v.copy() for name, v in first.items() if isinstance(v, np.ndarray)}
    agent.step(24)
    second = agent.get_frame()
    assert (second["main"] != first["main"]).any()
    for name, before in kept.items():
        assert np.array_equal(first[name], before, equal_nan=True)
        assert not np.shares_memory(first[name], second[name])


def test_time_and_numbers_are_the_simulations(agent: Agent) -> None:
    """Stamps are simulated time, dt the time between two frames, numbers count from 1."""
    first = agent.get_frame()
    assert agent.step(24) == 100_000_000
    second = agent.get_frame()
    third = agent.get_frame()
    assert [f["sequence"] for f in (first, second, third)] == [1, 2, 3]
    assert [f["stamp_ns"] for f in (first, second, third)] == [0, 100_000_000, 100_000_000]
    assert second["dt"] == second["deltaTime"] == pytest.approx(0.1, abs=1e-12)
    assert not first["flow_valid"].any()
    assert second["flow_valid"].all()


def test_a_frame_shows_what_was_asked_before(agent: Agent) -> None:
    """Each pose that was set is in the very next frame, though time stands still."""
    agent.set_follow(False)
    for number in range(12):
        pose = look_at((4.0 + 0.1 * number, 0.3 * number, 1.5), (0.0, 0.0, 1.0))
        agent.set_pose(pose)
        frame = agent.get_frame()
        position = (4.0 + 0.1 * number, 0.3 * number, 1.5)
        assert frame["world_from_camera"][:3, 3] == pytest.approx(position, abs=1e-9)


def test_a_body_is_seen_where_its_pose_projects_to(agent: Agent) -> None:
    """K and world_from_camera put the red cube's centre on pixels of its id, at its depth."""
    ids = {instance.name: number for number, instance in agent.instances.items()}
    agent.set_follow(False)
    centre = np.array([0.0, 0.0, 1.25])
    for eye in ((4.4, 0.0, 1.8), (1.0, 1.5, 5.0), (-1.5, -1.0, 4.5)):
        agent.set_pose(look_at(eye, centre + np.array([0.2, 0.1, -0.1])))
        frame = agent.get_frame()
        seen = np.linalg.inv(frame["world_from_camera"]) @ np.append(centre, 1.0)
        u, v, w = frame["K"] @ seen[:3]
        column, row = round(u / w), round(v / w)
        assert frame["instance"][row, column] == ids["red cube"]
        half_diagonal = 0.55 * math.sqrt(3.0)
        assert seen[2] - half_diagonal < frame["depth_m"][row, column] < seen[2]


def test_views_agree_with_each_other(agent: Agent) -> None:
    """Category and colour of a pixel are those of its instance; the tables know every id."""
    frame = agent.get_frame()
    for number in np.unique(frame["instance"]):
        mask = frame["instance"] == number
        category = agent.instances[number].category_id if number else 0
        assert (frame["category"][mask] == category).all()
        assert len(np.unique(frame["object"][mask], axis=0)) == 1
        assert agent.categories[category]


def test_views_that_are_not_wanted_do_not_come(keeper: Agent) -> None:
    """An Agent with one active view receives that alone, and views beyond the five on request."""
    switches = {f"{kind}_frame_active": False for kind in ("main", "object", "category", "flow")}
    with Agent(**SMALL, **switches, views=["normals"], namespace=NAMESPACE) as agent:
        frame = agent.get_frame()
    assert set(frame["sizes"]) == {"depth", "normals"}
    assert frame["normals"].shape == (120, 160, 3)
    assert "main" not in frame


def test_two_agents_of_different_size_see_their_own(agent: Agent) -> None:
    """Agents have sizes, poses and frames of their own, also when they ask at the same time."""
    with Agent(width=64, height=48, namespace=NAMESPACE) as small:
        small.set_follow(False)
        small.set_position((3.0, 0.0, 2.5))
        agent.set_follow(False)
        agent.set_position((0.0, 3.0, 1.0))
        with ThreadPoolExecutor(2) as pool:
            tasks = [pool.submit(which.get_frame) for which in (agent, small) * 4]
            frames = [task.result(30) for task in tasks]
    assert [f["main"].shape for f in frames] == [(120, 160, 3), (48, 64, 3)] * 4
    for frame, position in zip(frames, [(0.0, 3.0, 1.0), (3.0, 0.0, 2.5)] * 4, strict=True):
        assert frame["world_from_camera"][:3, 3] == pytest.approx(position, abs=1e-9)


# -- where it is ---------------------------------------------------------------------------


def test_positions_and_rotations_are_what_was_set(agent: Agent) -> None:
    """Metres and degrees about fixed axes come back as they were given."""
    agent.set_follow(False)
    agent.set_position((1.5, -2.0, 0.75))
    agent.set_rotation((10.0, -20.0, 130.0))
    assert agent.get_position() == pytest.approx((1.5, -2.0, 0.75), abs=1e-12)
    assert agent.get_rotation() == pytest.approx((10.0, -20.0, 130.0), abs=1e-9)
    assert agent.get_pose().position_m == agent.get_position()


def test_following_can_be_toggled(agent: Agent) -> None:
    """An agent follows its mover, stays behind when told to, and says which it does."""
    before = agent.get_position()
    agent.step(240)
    moved = agent.get_position()
    assert math.dist(before, moved) > 0.1
    assert agent.toggle_follow() is False
    agent.step(240)
    assert agent.get_position() == moved
    assert agent.toggle_follow() is True
    assert agent.get_position() != moved


def test_flow_shows_set_poses_and_not_teleports(agent: Agent) -> None:
    """A camera that is moved by its user moves; one that teleports has no past."""
    agent.set_follow(False)
    agent.set_position((4.0, 0.0, 1.5))
    agent.get_frame()
    agent.step(8)
    agent.set_position((3.9, 0.0, 1.5))
    assert agent.get_frame()["flow_valid"].any()
    agent.step(8)
    agent.set_position((3.0, 0.0, 1.5), teleport=True)
    frame = agent.get_frame()
    assert not frame["flow_valid"].any()
    assert not frame["flow"].any()


# -- the scene -----------------------------------------------------------------------------


def test_the_scene_can_be_changed(agent: Agent) -> None:
    """After the call everything an Agent tells is of the new scene, at its time 0."""
    agent.step(24)
    assert {"optical", "object_view"} <= set(agent.scenes)
    try:
        agent.change_scene("object_view")
        assert agent.scene == "object_view"
        names = {instance.name for instance in agent.instances.values()}
        frame = agent.get_frame()
        assert (frame["scene"], frame["stamp_ns"]) == ("object_view", 0)
        assert not frame["flow_valid"].any()
        assert "red cube" not in names
    finally:
        agent.change_scene("optical")


def test_the_tables_describe_the_scene(agent: Agent) -> None:
    """Objects, categories, spawnables and lights have the scene's own names."""
    cube = next(i for i in agent.instances.values() if i.name == "red cube")
    assert (cube.category, agent.categories[cube.category_id]) == ("cube", "cube")
    assert (cube.static, cube.moving) == (False, True)
    assert "cube" in agent.spawnable_objects_names
    assert agent.lights_names == ["sun", "fill"]


def test_a_reset_brings_every_byte_back(agent: Agent) -> None:
    """The same seed and the same calls give the same annotations."""

    def run() -> list[bytes]:
        agent.reset(seed=5)
        seen = []
        for _ in range(3):
            agent.step(16)
            frame = agent.get_frame()
            views = ("depth_m", "category", "instance", "flow", "flow_valid")
            seen += [frame[name].tobytes() for name in views]
        return seen

    assert run() == run()


# -- what cannot be ------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        ({"width": 0}, InvalidRequest, "width must be an integer from 8 to 4096"),
        ({"height": 100000}, InvalidRequest, "height must be an integer from 8 to 4096"),
        ({"views": ["heat"]}, UnknownName, "view must be one of"),
        ({"name": "No Name"}, InvalidRequest, "name of the agent"),
        ({"domain_id": 233}, InvalidRequest, "ROS_DOMAIN_ID must be an integer from 0 to 232"),
        ({"far_m": 0.01}, InvalidRequest, "near_m must be less than far_m"),
    ],
)
def test_arguments_that_cannot_be_are_refused_at_once(
    arguments: dict[str, object], error: type[Exception], words: str
) -> None:
    """A wrong argument is told in one sentence, before any simulator is started."""
    with pytest.raises(error, match=words):
        Agent(**{"namespace": "/never", **arguments})
    assert not simulator_is_present(domain(), "/never")


def test_refusals_come_in_the_simulators_words(agent: Agent) -> None:
    """What the simulator refuses raises its own sentence, and the agent goes on."""
    here = agent.get_position()
    with pytest.raises(InvalidRequest, match="did you mean 'optical'"):
        agent.change_scene("optcal")
    with pytest.raises(InvalidRequest, match="steps must be an integer from 1"):
        agent.step(-1)
    with pytest.raises(InvalidState, match="lockstep"):
        agent.pause()
    with pytest.raises(InvalidRequest, match="seed must be"):
        agent.reset(seed=-4)
    for position in ((math.nan, 0, 0), (0, math.inf, 0), (0, 0), "here", (1e9, 0, 0)):
        with pytest.raises((InvalidRequest), match="position must be"):
            agent.set_position(position)
    assert agent.get_position() == here
    assert agent.scene == "optical"


def test_values_that_no_message_holds_are_refused(agent: Agent) -> None:
    """A wrong type or a number too big is told like any other wrong argument."""
    for ask in (
        lambda: agent.step(1.5),
        lambda: agent.step(2**70),
        lambda: agent.reset(seed="a"),
        lambda: agent.change_scene(None),
        lambda: agent.change_scene("\ud800"),
        lambda: agent.set_pose((1.0, 2.0, 3.0)),
    ):
        with pytest.raises(InvalidRequest, match="must be"):
            ask()
    assert agent.get_frame()["sequence"] == 1


def test_a_name_is_given_once(agent: Agent) -> None:
    """A second agent of one name is refused, and the first one is unharmed."""
    with pytest.raises(InvalidRequest, match="not in use"):
        Agent(**SMALL, name=agent.id, namespace=NAMESPACE)
    assert agent.get_frame()["sequence"] == 1


# -- life ----------------------------------------------------------------------------------


def test_an_agent_can_be_deleted_and_registered_again(agent: Agent) -> None:
    """Deleting removes it from the simulator, twice is harmless, registering brings it back."""
    agent.get_frame()
    agent.delete()
    agent.delete()
    with pytest.raises(SimulationClosed, match="was deleted"):
        agent.get_frame()
    agent.register()
    agent.register()
    assert agent.get_frame()["sequence"] == 1


def test_closing_leaves_nothing_behind(keeper: Agent) -> None:
    """A closed Agent is gone from the simulator; closing twice does nothing, asking raises."""
    agent = Agent(**SMALL, namespace=NAMESPACE)
    agent.close()
    agent.close()
    until(lambda: agent.id not in [spec.name for spec in keeper.info.agents], "its end")
    with pytest.raises(SimulationClosed):
        agent.get_frame()


def test_agents_that_come_and_go_leave_no_threads(keeper: Agent) -> None:
    """Twenty agents later there are as many threads as before."""
    before = threading.active_count()
    for _ in range(20):
        with Agent(width=16, height=16, namespace=NAMESPACE) as agent:
            agent.get_frame()
    assert threading.active_count() == before


def test_agents_that_come_and_go_leave_nothing_in_the_shared_node(keeper: Agent) -> None:
    """A callback group refers for ever to each entity that was ever added to it."""
    kept = keeper._remote.connection.node.default_callback_group.entities
    before = len(kept)
    for _ in range(3):
        with Agent(**SMALL, namespace=NAMESPACE) as agent:
            agent.get_frame()
    assert len(kept) == before


def test_an_agent_lives_beside_the_users_own_node(keeper: Agent) -> None:
    """A user's rclpy, started before or after, is neither needed nor disturbed."""
    code = """
import rclpy, sys
from sensor_msgs.msg import CameraInfo
from sailenv_ros import Agent, CameraIntrinsics
rclpy.init()
node = rclpy.create_node("mine")
offset = dict(cx_offset_px=8.0, cy_offset_px=-5.0)
lens = CameraIntrinsics(width=64, height=48, fx_px=50.0, fy_px=40.0, **offset)
with Agent(intrinsics=lens, namespace="/tested", name="beside") as agent:
    got = []
    node.create_subscription(CameraInfo, "/tested/beside/camera_info", got.append, 3)
    for _ in range(100):
        frame = agent.get_frame()
        rclpy.spin_once(node, timeout_sec=0.05)
        if got:
            break
    assert got and got[0].width == 64
    assert (got[0].k[2], got[0].k[5]) == (got[0].p[2], got[0].p[6]) == (31.5 + 8.0, 23.5 - 5.0)
    assert (got[0].k[0], got[0].k[4]) == (50.0, 40.0)
    assert tuple(frame["K"].ravel()) == tuple(got[0].k)
assert rclpy.ok()
node.create_publisher(CameraInfo, "still_works", 1).publish(CameraInfo())
node.destroy_node()
rclpy.shutdown()
"""
    run_python(code)


def run_python(code: str) -> str:
    """Run a program of its own; return what it prints."""
    with program(code) as running:
        out, _ = running.communicate(timeout=90)
    assert running.returncode == 0
    return out


def program(code: str) -> subprocess.Popen[str]:
    """Start a program of its own that can be talked to."""
    return subprocess.Popen(
        [sys.executable, "-c", code],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )


def line_of(running: subprocess.Popen[str]) -> str:
    """Read the next line that a program prints."""
    assert running.stdout is not None
    return running.stdout.readline().strip()


# -- simulators that come and go -----------------------------------------------------------


def test_a_killed_simulator_is_told_at_once() -> None:
    """kill -9 makes requests raise SimulatorLost, for the Agent that started it and others."""
    code = """
import sys
from sailenv_ros import Agent
from sailenv_ros.errors import SimulatorLost
with Agent(width=64, height=48, namespace="/killed") as agent:
    assert agent.simulator_pid is None
    agent.get_frame()
    print("joined", flush=True)
    sys.stdin.readline()
    try:
        agent.get_frame()
    except SimulatorLost as lost:
        print("lost:", lost, flush=True)
"""
    with (
        Agent(**SMALL, namespace="/killed", simulator=LOCKSTEP) as agent,
        program(code) as joiner,
    ):
        agent.get_frame()
        assert line_of(joiner) == "joined"
        assert agent.simulator_pid is not None
        os.kill(agent.simulator_pid, signal.SIGKILL)
        out, _ = joiner.communicate("\n", timeout=60)
        assert out.startswith("lost: the simulator has ended")
        assert joiner.returncode == 0
        with pytest.raises(SimulatorLost, match=r"the simulator has ended; .* did not come \("):
            agent.get_frame()
        with pytest.raises(SimulatorLost, match=r"the simulator has ended; .* did not come \("):
            agent.get_position()
        # A new Agent starts a new simulator, while the old one is still open.
        with Agent(**SMALL, namespace="/killed", simulator=LOCKSTEP) as successor:
            assert successor.get_frame()["sequence"] == 1


def test_a_simulator_that_was_started_ends_with_its_last_agent() -> None:
    """It serves several Agents, outlives the first and ends with the last."""
    first = Agent(**SMALL, namespace="/shared", simulator=LOCKSTEP)
    second = Agent(**SMALL, namespace="/shared")
    assert first.simulator_pid == second.simulator_pid
    first.close()
    assert second.get_frame()["sequence"] == 1
    assert simulator_is_present(domain(), "/shared")
    second.close()
    assert not simulator_is_present(domain(), "/shared")


def test_two_programs_that_start_together_share_one_simulator() -> None:
    """Of two simulators of one name one gives way, and both programs get their frames."""
    code = """
import sys
from sailenv_ros import Agent
start = {"scene": "optical", "mode": "lockstep", "agent.name": ""}
with Agent(width=64, height=48, namespace="/raced", simulator=start) as agent:
    agent.get_frame()
    print(agent.simulator_pid, flush=True)
    sys.stdin.readline()
"""
    with program(code) as one, program(code) as other:
        started = {running: line_of(running) != "None" for running in (one, other)}
        assert sorted(started.values()) == [False, True]
        # The one that joined goes first, as the simulator ends with the one that started it.
        for running in sorted(started, key=started.__getitem__):
            running.communicate("\n", timeout=60)
            assert running.returncode == 0


def test_a_program_that_dies_takes_its_simulator_along() -> None:
    """A killed program cannot close anything; its simulator ends by itself."""
    code = """
import sys
from sailenv_ros import Agent
agent = Agent(width=64, height=48, namespace="/orphan", simulator={"agent.name": ""})
print("up", flush=True)
sys.stdin.readline()
"""
    with program(code) as running:
        assert line_of(running) == "up"
        assert simulator_is_present(domain(), "/orphan")
        running.kill()
    until(lambda: not simulator_is_present(domain(), "/orphan"), "the orphan's end")


def test_a_simulator_that_cannot_start_says_why() -> None:
    """The node's own sentence reaches the program that wanted it."""
    with pytest.raises(SimulationClosed, match=r"status 2.*did you mean 'optical'"):
        Agent(**SMALL, namespace="/failing", simulator={"scene": "optcal"})
    with pytest.raises(InvalidRequest, match="parameter scene"):
        Agent(**SMALL, namespace="/failing", simulator={"scene": None})
    assert not simulator_is_present(domain(), "/failing")


def test_forked_workers_make_agents_of_their_own(keeper: Agent) -> None:
    """An inherited Agent refuses to work; those of the workers work side by side with it."""
    code = """
import multiprocessing, warnings
from sailenv_ros import Agent
from sailenv_ros.errors import SimulationClosed

def work(inherited, all_are_here, answers):
    try:
        inherited.get_frame()
    except SimulationClosed as error:
        answers.put(str(error)[-42:])
    inherited.close()
    with Agent(width=64, height=48, namespace="/tested", start_timeout_s=20) as own:
        all_are_here.wait(60)
        answers.put(own.get_frame()["main"].shape)

warnings.simplefilter("ignore", DeprecationWarning)  # Python 3.12 on forks beside threads
forking = multiprocessing.get_context("fork")
answers = forking.Queue()
with Agent(width=64, height=48, namespace="/tested") as agent:
    agent.get_frame()
    job = (agent, forking.Barrier(2), answers)
    workers = [forking.Process(target=work, args=job, daemon=True) for _ in range(2)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join(80)
        assert worker.exitcode == 0, worker.exitcode
    assert agent.get_frame()["main"].shape == (48, 64, 3)
heard = sorted(str(answers.get(timeout=10)) for _ in range(4))
print(heard)
"""
    told = "inherited by a fork: make it in the worker"
    assert run_python(code) == f"{['(48, 64, 3)'] * 2 + [told] * 2}\n"


def test_the_first_example_runs(tmp_path: Path) -> None:
    """It prints every view and writes a contact sheet."""
    example = Path(__file__).parents[2] / "examples" / "00_hello_frame.py"
    code = f"import sys, runpy; sys.argv[1:] = [{str(tmp_path / 'sheet.png')!r}]; "
    out = run_python(code + f"runpy.run_path({str(example)!r}, run_name='__main__')")
    for name in ("main", "depth", "depth_m", "category", "instance", "object", "flow"):
        assert any(line.startswith(name) for line in out.splitlines()), out
    assert (tmp_path / "sheet.png").stat().st_size > 10_000


def test_one_view_by_its_name_and_one_place_by_one_pose(agent: Agent) -> None:
    """As a `Simulation` has it."""
    assert list(agent.capture("depth")) == ["depth"]
    assert "normals" in agent.get_frame("normals")
    before = agent.instances
    for places in ({"position": (0, 0, 3)}, {"rotation": (0, 0, 90)}):
        with pytest.raises(InvalidRequest, match="pose must be left out"):
            agent.spawn_object("Cube", **places, pose=Pose())
        with pytest.raises(InvalidRequest, match="pose must be left out"):
            agent.move_object("red cube", **places, pose=Pose())
    assert agent.instances == before


def test_an_agent_cannot_be_sent_to_another_process(agent: Agent) -> None:
    """It is told in the same words as to a fork."""
    for copied in (pickle.dumps, copy.deepcopy):
        with pytest.raises(WrongProcess, match="this Agent works in the process that made it"):
            copied(agent)


def test_a_text_with_a_nul_is_refused(agent: Agent) -> None:
    """The messages' C code would cut it off there, and another object would be spawned."""
    before = agent.instances
    for attempt in (
        lambda: agent.spawn_object("Cube\0x"),
        lambda: agent.change_scene("optical\0x"),
        lambda: agent.spawn_object("Cube", object_name="a\0b"),
    ):
        with pytest.raises(InvalidRequest, match="without a NUL"):
            attempt()
    assert agent.instances == before


def test_a_namespace_that_ros_refuses_is_a_sentence() -> None:
    """Before anything is started."""
    with pytest.raises(InvalidRequest, match="namespace must be names divided by '/'"):
        Agent(namespace="my simulator")
