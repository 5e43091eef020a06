"""Recording in process: every frame exactly once, and the same bytes every time."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader

from sailenv_ros.cli import scene_bake
from sailenv_ros.cli.main import main
from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.frame.language.facts_text import facts_of_text
from sailenv_ros.recording.channels import AGENT_TOPICS, IMAGE, SCENE_INFO, message_of
from sailenv_ros.recording.frames import RecordedFrames, recorded_agents
from sailenv_ros.recording.lockstep import record_lockstep
from sailenv_ros.recording.progress import progress_line, size_in_bytes
from sailenv_ros.recording.reader import RecordingReader
from sailenv_ros.recording.writer import RecordingWriter
from sailenv_ros.simulation import Simulation
from sailenv_ros.simulation.scene_facts import scene_facts
from sailenv_ros.types.agents import AgentSpec, due_steps
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.rigs import RigCamera

pytestmark = pytest.mark.ros

SMALL = CameraIntrinsics(width=16, height=12)


def simulation(**kwargs: object) -> Simulation:
    settings = {"mode": "lockstep", "backend": "native", **kwargs}
    made = Simulation("optical", **settings)  # type: ignore[arg-type]  # settings of a test
    made.register_agent(AgentSpec(name="fast", intrinsics=SMALL, rate_hz=30.0))
    made.register_agent(AgentSpec(name="slow", intrinsics=SMALL, rate_hz=7.0, views=("rgb",)))
    return made


def infos(path: Path, agent: str) -> list[object]:
    with path.open("rb") as stream:
        found = make_reader(stream).iter_messages(topics=[f"/sailenv/{agent}/frame_info"])
        return [message_of("sailenv_msgs/msg/FrameInfo", message.data) for _, _, message in found]


def test_every_frame_is_recorded_exactly_once(tmp_path: Path) -> None:
    """Numbers have no gap, stamps lie on each agent's grid, each agent has its own views."""
    told: list[int] = []
    with simulation() as running, RecordingWriter(tmp_path / "bag") as writer:
        count = record_lockstep(running, writer, frames=9, on_frame=told.append)
    assert count == 18
    assert told == list(range(1, 19))
    for agent, rate, views in (("fast", 30.0, 5), ("slow", 7.0, 1)):
        read = infos(tmp_path / "bag/bag_0.mcap", agent)
        assert [info.sequence for info in read] == list(range(1, 10))  # type: ignore[attr-defined]
        assert {len(info.views) for info in read} == {views}  # type: ignore[attr-defined]
        stamps = [info.header.stamp for info in read]  # type: ignore[attr-defined]
        expected = [step * 1_000_000_000 // 240 for step in due_steps(rate, 9)]
        assert [stamp.sec * 1_000_000_000 + stamp.nanosec for stamp in stamps] == expected


def test_facts_of_the_scene_come_back(tmp_path: Path) -> None:
    """What two agents see at the same instant has the same facts, which change as things move."""
    with simulation() as running, RecordingWriter(tmp_path / "bag") as writer:
        begun = running.read(scene_facts)
        record_lockstep(running, writer, frames=3, facts=True)
        ended = running.read(scene_facts)
    with RecordingReader(tmp_path / "bag") as reader:
        fast, slow = (list(RecordedFrames(reader, name)) for name in ("fast", "slow"))
    told = [frame.facts for frame in (*fast, *slow)]
    assert [facts.sim_time_ns for facts in told if facts] == [
        frame.stamp_ns for frame in (*fast, *slow)
    ]
    for facts, meant in ((fast[0].facts, begun), (slow[0].facts, begun), (slow[2].facts, ended)):
        assert facts is not None
        assert facts.gaps == meant.gaps
        assert facts.enclosed == meant.enclosed
        assert facts.openings == meant.openings
        assert facts.materials == meant.materials
        for space, other in zip(facts.spaces, meant.spaces, strict=True):
            np.testing.assert_array_equal(space.cells, other.cells)
            assert (space.body, space.origin_m) == (other.body, other.origin_m)
    assert begun.materials
    with pytest.raises(InvalidRequest, match="fields of SceneFacts"):
        facts_of_text("[]")


def test_the_same_call_gives_the_same_messages(tmp_path: Path) -> None:
    """Two recordings differ in nothing but how long rendering took."""

    def same(name: str, data: bytes) -> object:
        kind = AGENT_TOPICS.get(name, SCENE_INFO)
        message = message_of(kind, data)
        if name == "frame_info":
            message.render_s = 0.0
        # Of the images the very bytes.
        return data if kind == IMAGE else message

    def record(folder: Path) -> list[tuple[object, ...]]:
        with simulation(seed=5) as running, RecordingWriter(folder) as writer:
            record_lockstep(running, writer, frames=4)
        with (folder / f"{folder.name}_0.mcap").open("rb") as stream:
            return [
                (channel.topic, message.log_time, same(Path(channel.topic).name, message.data))
                for _, channel, message in make_reader(stream).iter_messages()
            ]

    assert record(tmp_path / "one") == record(tmp_path / "two")


def test_what_cannot_be_recorded_is_refused(tmp_path: Path) -> None:
    """A running simulation, unknown names and no frames are refused before anything is written."""
    with simulation() as running, RecordingWriter(tmp_path / "bag") as writer:
        with pytest.raises(InvalidRequest, match="frames must be 1 or more"):
            record_lockstep(running, writer, frames=0)
        with pytest.raises(UnknownName, match="'slow'"):
            record_lockstep(running, writer, frames=1, agents=["slaw"])
        with pytest.raises(UnknownName, match="rgb"):
            record_lockstep(running, writer, frames=1, views=["rgbd"])
        assert writer.statistics.messages == 0
    with (
        Simulation("optical", backend="native") as running,
        RecordingWriter(tmp_path / "other") as writer,
    ):
        running.register_agent(AgentSpec(name="eye", intrinsics=SMALL))
        with pytest.raises(InvalidRequest, match="lockstep"):
            record_lockstep(running, writer, frames=1)


def test_the_command_makes_a_bag(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """`sailenv record --lockstep` prints the bag's path, and how it went on standard error."""
    bag = tmp_path / "bag"
    words = ["record", "--lockstep", "--frames", "3", "--width", "16", "--height", "12"]
    words += ["--scene", "optical"]
    assert main([*words, "--backend", "native", "-o", str(bag)]) == 0
    said = capsys.readouterr()
    assert said.out.strip() == str(bag)
    assert said.err.startswith("3 frames")
    assert "dropped 0" in said.err
    assert len(infos(bag / "bag_0.mcap", "agent")) == 3
    assert main([*words, "--backend", "native", "-o", str(bag)]) == 2
    assert "exists already" in capsys.readouterr().err
    assert main(["record", "--lockstep", "-o", str(tmp_path / "b")]) == 2
    assert main(["record", "--frames", "3", "-o", str(tmp_path / "b")]) == 2


def test_the_command_bakes_first_unless_it_is_told_not_to(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A folder that is taken is refused before anything is baked."""
    monkeypatch.setenv("SAILENV_CACHE", str(tmp_path / "cache"))
    scene, bag = tmp_path / "cell.yaml", tmp_path / "bag"
    scene.write_text("version: 1\ntitle: Cell\nroom: {size: [2, 2, 2]}\n")
    asked: list[str] = []
    monkeypatch.setattr(
        scene_bake, "ensure_baked", lambda scene, *, allow_modules: asked.append(scene)
    )
    words = ["record", "--lockstep", "--frames", "2", "--width", "16", "--height", "12"]
    words += ["--scene", str(scene), "--backend", "native", "-o", str(bag), "--quiet"]
    assert main(words) != 0  # nothing was baked by what stands in for the bake
    assert "is not baked" in capsys.readouterr().err
    assert asked == [str(scene)]
    assert not bag.exists()
    assert main([*words, "--light", "plain"]) == 0
    assert main(words) == 2
    assert "exists already" in capsys.readouterr().err
    assert asked == [str(scene)]


def test_the_progress_line_tells_all() -> None:
    """Frames, MB/s and what was dropped."""
    line = progress_line(
        frames=60, message_bytes=368_000_000, file_bytes=2_000_000, elapsed_s=2.0, dropped=3
    )
    expected = "60 frames (30.0/s), 368.0 MB (184.0 MB/s), 2.0 MB on disk, dropped 3"
    assert line == expected


def test_sizes_are_read_with_their_units() -> None:
    """Powers of ten by K, M and G; anything else is refused."""
    assert [size_in_bytes(text) for text in ("12", "500M", "1.5GB", "2k")] == [
        12,
        500_000_000,
        1_500_000_000,
        2_000,
    ]
    for text in ("much", "-1", "inf", ""):
        with pytest.raises(InvalidRequest, match="500M"):
            size_in_bytes(text)


def test_a_rig_is_recorded_with_its_cameras(tmp_path: Path) -> None:
    """Each is found by its name, with the pose, the scene and the P of its place in the rig."""
    cameras = {
        "left": RigCamera(intrinsics=SMALL, extrinsics=Pose((0.0, 0.05, 0.0)), views=("depth",)),
        "right": RigCamera(intrinsics=SMALL, extrinsics=Pose((0.0, -0.05, 0.0)), views=("depth",)),
    }
    rig = AgentSpec(name="rig", intrinsics=SMALL, rate_hz=30.0, cameras=cameras)
    with (
        Simulation("optical", mode="lockstep", backend="native", agent=rig) as running,
        RecordingWriter(tmp_path / "bag") as writer,
    ):
        live = running.capture_rig()
        running.reset()
        assert record_lockstep(running, writer, frames=2) == 6
    with RecordingReader(tmp_path / "bag") as reader:
        assert set(recorded_agents(reader)) == {"rig", "rig/left", "rig/right"}
        for side, tx in (("left", 0.0), ("right", -0.1 * SMALL.fx)):
            first, second = RecordedFrames(reader, f"rig/{side}")
            assert (first.stamp_ns, second.stamp_ns) == (0, 33_333_333)
            assert first["depth"].tobytes() == live[side]["depth"].tobytes()
            expected = live[side].camera.pose.matrix()
            assert abs(first.camera.pose.matrix() - expected).max() < 1e-9
            assert first.info is not None
            extrinsics = {one.name: one.extrinsics for one in first.info.agents}
            assert extrinsics[f"rig/{side}"] == cameras[side].extrinsics
            with (tmp_path / "bag/bag_0.mcap").open("rb") as stream:
                topics = [f"/sailenv/rig/{side}/camera_info"]
                messages = [m for *_, m in make_reader(stream).iter_messages(topics=topics)]
            told = message_of("sensor_msgs/msg/CameraInfo", messages[0].data)
            assert told.p[3] == pytest.approx(tx)
