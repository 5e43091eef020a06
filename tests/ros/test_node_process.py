"""How the process of sim_node begins and ends: exit statuses, one line of reason, nothing left."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
from sensor_msgs.msg import Image

from sailenv_msgs.srv import Reset, Step
from tests.support.ros_probe import BEST_EFFORT, Probe
from tests.support.sim_node_process import NodeProcess
from tests.support.tool_process import run_several
from tests.support.waiting import until

pytestmark = pytest.mark.ros

SMALL = {"mode": "lockstep", "agent__width": 64, "agent__height": 48}
QUIET = {"scene": "optical", "publish_clock": False, "gateway.port": 0, "viewer.port": 0}


@pytest.fixture
def node() -> Iterator[NodeProcess]:
    """A small lockstep simulator."""
    with NodeProcess("/ending", **SMALL) as node:
        yield node


@pytest.fixture(scope="module")
def standing() -> Iterator[NodeProcess]:
    """One that no test ends."""
    with NodeProcess("/standing", **SMALL) as node:
        yield node


# -- the end -------------------------------------------------------------------------------


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_cleanly(node: NodeProcess, number: int) -> None:
    """Status 0, no word of trouble, no shared memory left, though the signal comes again."""
    segments = node.segments()
    assert segments
    node.signal(number)

    def ended() -> bool:
        node.signal(signal.SIGINT)
        return not node.alive

    until(ended, "its end")
    assert node.status() == 0
    assert {path for path in segments if path.exists()} == set()
    assert "Traceback" not in node.log
    assert "ERROR" not in node.log


def test_a_signal_ends_it_at_work(node: NodeProcess) -> None:
    """A million steps that have just begun do not keep it, nor does a streaming subscriber."""
    segments = node.segments()
    with Probe("/ending") as probe:
        images = probe.listen(Image, "agent/rgb")

        def streams() -> bool:
            probe.done(Step, "step", Step.Request(steps=8))
            return bool(images.messages)

        until(streams, "an image")
        probe.begin(Step, "step", Step.Request(steps=1_000_000))
        known = len(images.messages)
        until(lambda: len(images.messages) > known, "an image of the long step")
        node.signal(signal.SIGTERM)
        assert node.status() == 0
    assert {path for path in segments if path.exists()} == set()


def test_a_signal_ends_it_while_it_starts() -> None:
    """Before the scene is there, a signal ends it with status 0 as well."""
    with NodeProcess("/starting", ready=False, **SMALL) as node:
        # Its lock is the first thing that it makes known; the scene is loaded after that.
        until(lambda: _dds_begun(node), "the node to begin")
        node.signal(signal.SIGTERM)
        assert node.status() == 0
        assert "Traceback" not in node.log


def test_the_death_of_a_parent_ends_it() -> None:
    """A pipe whose other end is closed ends the node as a signal does."""
    read_end, write_end = os.pipe()
    arguments = ("--end-with-fd", str(read_end))
    with NodeProcess("/child", arguments=arguments, pass_fds=(read_end,), **SMALL) as node:
        os.close(read_end)
        segments = node.segments()
        os.close(write_end)
        assert node.status() == 0
        assert {path for path in segments if path.exists()} == set()


# -- the beginning -------------------------------------------------------------------------


WRONG: tuple[tuple[dict[str, object], str], ...] = (
    ({"scene": "opticle"}, "scene must be one of: "),
    ({"agent.width": 3}, "parameter agent.width must be an integer from 8 to 4096"),
    ({"agent.near_m": 200.0}, "near_m must be less than far_m"),
    ({"agent.name": "No Name"}, "name of the agent must be"),
    ({"mode": "fast"}, "parameter mode must be one of: realtime, lockstep, got 'fast'"),
    ({"use_sim_time": True}, "use_sim_time must be false for the simulator, which is the source"),
    ({"seed": "many"}, "parameter seed must be of the type of 0, got 'many'"),
    ({"widht": 3}, "parameter must be one of: scene,"),
    ({"scene_paths": 3}, "parameter scene_paths must be of the type of"),
    ({"gateway.port": 45_100, "gateway.host": "203.0.113.1"}, "address of the gateway"),
)


def test_wrong_parameters_end_it_with_a_reason(tmp_path: Path) -> None:
    """Status 2 and one line that says what was wrong and what is accepted; a scene's, with places.

    So does an argument that ROS does not understand.
    """
    scene = tmp_path / "broken.yaml"
    scene.write_text("version: 1\ntitle: Broken\nobjcts: []\nlights: 3\n", encoding="utf-8")
    settings = [{**QUIET, **parameters} for parameters, _ in WRONG]
    *runs, faulty, nonsense = run_several(
        "sim_node", "/wrong", *settings, {**QUIET, "scene": str(scene)}, ("-r", "nonsense")
    )
    for (_, sentence), (_, log) in zip(WRONG, runs, strict=True):
        [fatal] = [line for line in log.splitlines() if "[FATAL]" in line]
        assert sentence in fatal
    assert f"{scene}:3:1" in faulty[1]
    assert f"{scene}:4:" in faulty[1]
    for status, log in (*runs, faulty, nonsense):
        assert status == 2
        assert "Traceback" not in log


def test_a_wrong_domain_ends_it_with_a_reason() -> None:
    """Status 2 where it is beyond the numbers of domains."""
    with NodeProcess("/wrong", ready=False, environment={"ROS_DOMAIN_ID": "233"}) as node:
        assert node.status() == 2
        assert "ROS_DOMAIN_ID must be an integer from 0 to 232, got 233" in node.log


def test_a_second_simulator_of_one_namespace_is_refused(standing: NodeProcess) -> None:
    """Status 3; the first one does not notice, and another namespace is free."""
    with NodeProcess("/standing", ready=False, **SMALL) as second:
        assert second.status() == 3
        assert "not in use yet, got '/standing'" in second.log
    assert standing.alive
    elsewhere = "/standing/elsewhere"
    with NodeProcess(elsewhere, **SMALL) as third, Probe(elsewhere) as probe:
        probe.done(Reset, "reset", Reset.Request(keep_seed=True))
        assert third.alive


def test_it_greets_with_one_line(standing: NodeProcess) -> None:
    """The line names scene, namespace, renderer and agents, and how to see pictures."""
    [line] = [line for line in standing.lines if "to see:" in line]
    assert "scene 'optical' in /standing" in line
    assert "renderer: " in line
    assert "agents: agent" in line
    assert "/standing/agent/rgb" in line


def test_its_threads_share_memory(standing: NodeProcess) -> None:
    """Else they have a dozen heaps, which begin at multiples of 64 MiB, beside the first."""
    maps = Path(f"/proc/{standing.pid}/maps").read_text().splitlines()
    ranges = [line.split()[0].split("-") for line in maps if len(line.split()) == 5]
    begins = [int(begin, 16) for begin, _ in ranges]
    heaps = [begin for begin in begins if begin % 2**26 == 0]
    assert len(heaps) <= 2


def test_parameters_come_from_the_shipped_file_and_quality_of_service_from_overrides() -> None:
    """config/sim_node.yaml names parameters that exist, with the defaults that they have.

    A publisher takes over what `qos_overrides` says of its topic.
    """
    file = Path(__file__).parents[2] / "config" / "sim_node.yaml"
    override = "qos_overrides./overridden/agent/rgb.publisher.reliability:=best_effort"
    with (
        NodeProcess(
            "/overridden", remaps=("--params-file", str(file), "-p", override), **SMALL
        ) as node,
        Probe("/overridden") as probe,
    ):
        assert "agents: agent" in node.log
        topic = "/overridden/agent/rgb"
        until(lambda: probe.node.get_publishers_info_by_topic(topic), "the publisher")
        [publisher] = probe.node.get_publishers_info_by_topic(topic)
        assert publisher.qos_profile.reliability == BEST_EFFORT.reliability


def _dds_begun(node: NodeProcess) -> bool:
    try:
        return bool(node.segments()) or not node.alive
    except OSError:
        return not node.alive


def test_one_simulator_of_a_domain_publishes_the_clock() -> None:
    """The second one says why it does not, and takes over once the first is gone."""
    with NodeProcess("/first", publish_clock=True, agent__name="") as first:
        with NodeProcess("/second", publish_clock=True, agent__name="") as second:
            assert f"process {first.pid} publishes /clock" in second.log
            assert "publish_clock:=false" in second.log
            with Probe("/second") as probe:
                until(lambda: probe.node.count_publishers("/clock"), "the clock")
                assert probe.node.count_publishers("/clock") == 1
        assert "publishes /clock" not in first.log
    with NodeProcess("/second", publish_clock=True, agent__name="") as second:
        assert "publishes /clock" not in second.log
