"""Streams: their scripts against arithmetic, breaks, refusals, and what is written of them."""

from __future__ import annotations

import gzip
import itertools
import json
import signal
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sailenv_ros.cli.main import main
from sailenv_ros.dataset.streams import (
    STREAMS,
    StreamJob,
    StreamKind,
    make_stream,
    making,
    stream_named,
)
from sailenv_ros.errors import (
    BegunOtherwise,
    DeadlineExceeded,
    InvalidRequest,
    PlaceTaken,
    UnknownName,
)
from sailenv_ros.light.bake.fingerprint import fingerprint
from sailenv_ros.light.bake.pipeline import bake
from sailenv_ros.recording.frames import RecordedFrames
from sailenv_ros.recording.reader import RecordingReader
from sailenv_ros.scene.loader import load_scene
from sailenv_ros.simulation import finished_light
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.system.futures import wait_for
from sailenv_ros.types.baked_light import BakedLight
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.support.bake_scenes import COARSE

pytestmark = pytest.mark.ros


class Broken(Exception):
    """Stands for a power cut."""


def job(frames: int = 12, **changes: Any) -> StreamJob:
    settings = {"views": ("depth", "instance", "flow"), "backend": "native", **changes}
    return StreamJob(kind=STREAMS["solid"], frames=frames, **settings)


def array(path: Path) -> Any:
    """An array as their code reads it."""
    with gzip.open(path) as file:
        return np.load(file)


def messages(bag: Path) -> list[tuple[str, bytes]]:
    """Every message but those that say how long rendering took."""
    with RecordingReader(bag) as reader:
        return [
            (topic.name, bytes(message.data))
            for topic, message in reader.messages()
            if not topic.name.endswith("frame_info")
        ]


@pytest.mark.parametrize("name", [name for name, kind in STREAMS.items() if kind.laps])
def test_scripts_fill_their_laps(name: str) -> None:
    """One object moves at a time, each 18/19 of its share of the lap; then all begins again."""
    kind = stream_named(name)
    spec = load_scene(kind.scene)
    lap_s = kind.lap_frames / kind.rate_hz
    moving = [thing for thing in spec.objects if thing.behaviours]
    spans = []
    for thing in moving:
        (behaviour,) = thing.behaviours
        parameters = behaviour.parameters
        assert parameters["total_time"] + parameters["rest"] == pytest.approx(lap_s, abs=1e-5)
        start = parameters.get("start", 0.0)
        spans.append((start, start + parameters["total_time"]))
        first = parameters["waypoints"][0]
        np.testing.assert_allclose(thing.pose.position_m, first["position"], atol=1e-9)
    share = lap_s / len(moving)
    for number, (start, end) in enumerate(sorted(spans)):
        assert start == pytest.approx(number * share, abs=1e-3)
        assert end - start == pytest.approx(share * 18.0 / 19.0, abs=1e-3)
    agent = spec.agents[0]
    assert (agent.width, agent.height) == (256, 256)
    assert agent.rate == kind.rate_hz
    assert {"rgb", "depth", "category", "instance", "flow", "occlusion"} == set(agent.views)


def test_flow_is_zero_on_all_but_the_one_that_moves(tmp_path: Path) -> None:
    """The cylinder moves first; cube, sphere and background have flow of exactly 0."""
    bag = make_stream(job(6), tmp_path / "solid")
    with RecordingReader(bag) as reader:
        frames = RecordedFrames(reader, "")
        assert len(frames) == 6
        for number in range(1, 6):
            frame = frames[number]
            info = frames.scene_info(number)
            assert info is not None
            names = {i.name: i.id for i in info.instances}
            moves = (frame["flow"] != 0.0).any(axis=-1)
            on = frame["instance"] == names["cylinder"]
            assert moves[on].mean() > 0.99
            assert not moves[~on].any()
            assert frame.dt_ns == 125_000_000


def test_a_broken_stream_goes_on_with_the_same_messages(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(making, "PART_FRAMES", 5)
    whole = make_stream(job(), tmp_path / "a" / "solid")

    def break_off(done: int) -> None:
        if done == 8:
            raise Broken

    again = tmp_path / "b" / "solid"
    with pytest.raises(Broken):
        make_stream(job(), again, on_frame=break_off)
    assert not again.exists()
    told: list[int] = []
    make_stream(job(), again, on_frame=told.append)
    assert told[0] == 6
    assert messages(again) == messages(whole)
    assert sorted(path.name for path in again.iterdir()) == [
        "metadata.yaml", "solid_0.mcap", "solid_1.mcap", "solid_2.mcap", "stream.json",
    ]  # fmt: skip
    assert make_stream(job(), again) == again
    assert messages(again) == messages(whole)


@dataclass(frozen=True, slots=True, kw_only=True)
class CellKind(StreamKind):
    """A stream in a small room."""

    file: Path

    @property
    def scene(self) -> Path:
        return self.file


CELL_SCENE = """
version: 1
title: Cell
gravity: [0, 0, 0]
lights:
  - {name: lamp, type: point, position: [0, 0, 1.5]}
room: {size: [2, 2, 2]}
agents:
  - {name: eye, width: 24, height: 16, rate: 8, position: [-0.9, 0, 1.2], views: [rgb]}
objects:
  - name: ball
    asset: sphere
    scale: 0.4
    position: [0.3, 0, 1]
    behaviours:
      - type: catmull_waypoints
        total_time: 2
        waypoints: [{position: [0.3, 0, 1]}, {position: [0.3, 0.4, 1.2]}]
"""


@pytest.fixture
def cell(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> StreamJob:
    """A stream in a room of its own, with a cache of its own, in which bakes are coarse."""
    monkeypatch.setenv("SAILENV_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(making, "PART_FRAMES", 3)
    monkeypatch.setattr(finished_light, "bake", coarse_bake)
    scene = tmp_path / "cell.yaml"
    scene.write_text(CELL_SCENE)
    kind = CellKind(name="cell", title="Cell", rate_hz=8.0, lap_frames=8, file=scene)
    return StreamJob(kind=kind, frames=8, backend="native")


def coarse_bake(snapshot: WorldSnapshot) -> BakedLight:
    """Bake coarsely what is then kept as if it were fine."""
    settings = replace(COARSE, texel_m=0.3, rays=4, pass_rays=4)
    return replace(bake(snapshot, settings=settings), fingerprint=fingerprint(snapshot))


def test_pictures_do_not_depend_on_the_light_in_the_cache(cell: StreamJob, tmp_path: Path) -> None:
    """Plain ones have none of it; baked ones are baked first, and again where it is lost."""
    plain = messages(make_stream(cell, tmp_path / "plain" / "cell"))
    with_light = replace(cell, light="baked")
    (tmp_path / "baked").mkdir()
    baked = messages(make_stream(with_light, tmp_path / "baked" / "cell"))
    light = [*(tmp_path / "cache/light").glob("*.light")]
    assert len(light) == 1
    assert baked != plain
    assert messages(make_stream(cell, tmp_path / "again" / "cell")) == plain
    for path in light:
        path.rename(path.with_suffix(".draft"))
    assert messages(make_stream(with_light, tmp_path / "lost" / "cell")) == baked


def test_the_deadline_of_a_long_way_is_one_frames(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Frames that are passed over are not waited for all at once; what is late says so itself."""
    monkeypatch.setattr(making, "PART_FRAMES", 2)
    waited: list[str] = []

    def count(future: Any, what: str, timeout_s: float) -> Any:
        waited.append(what)
        if len(waited) == 9:
            raise DeadlineExceeded(what, timeout_s)
        return wait_for(future, what, timeout_s)

    def break_off(done: int) -> None:
        if done == 12:
            raise Broken

    bag = tmp_path / "solid"
    with pytest.raises(Broken):
        make_stream(job(14), bag, on_frame=break_off)
    monkeypatch.setattr(making, "wait_for", count)
    with pytest.raises(DeadlineExceeded, match="while waiting for physics to step to a frame"):
        make_stream(job(14), bag)


def test_a_broken_stream_keeps_its_light_and_models(
    cell: StreamJob, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It goes on with the light that it began with, or is refused."""

    def break_off(done: int) -> None:
        if done == 5:
            raise Broken

    job = replace(cell, light="baked")
    whole = messages(make_stream(job, tmp_path / "whole" / "cell"))
    bag = tmp_path / "cell"
    with pytest.raises(Broken):
        make_stream(job, bag, on_frame=break_off)
    with pytest.raises(BegunOtherwise, match=r"otherwise: light is '[0-9a-f]{32}', not 'plain'"):
        make_stream(cell, bag)
    with monkeypatch.context() as patch:
        patch.setattr(SceneLibrary, "asset_fingerprint", lambda self, name: f"other {name}")
        with pytest.raises(BegunOtherwise, match="begun otherwise: models is"):
            make_stream(job, bag)
    for path in (tmp_path / "cache/light").glob("*.light"):
        path.unlink()
    assert messages(make_stream(job, bag)) == whole


def test_folders_of_others_are_refused_and_left_alone(tmp_path: Path) -> None:
    mine = tmp_path / "mine"
    mine.mkdir()
    (mine / "thesis.tex").write_text("text")
    with pytest.raises(PlaceTaken, match="is not empty"):
        make_stream(job(), mine)
    file = tmp_path / "file"
    file.write_text("text")
    with pytest.raises(PlaceTaken, match="is no folder"):
        make_stream(job(), file)
    other = make_stream(job(2), tmp_path / "other")
    before = {path: path.read_bytes() for path in other.iterdir()}
    with pytest.raises(BegunOtherwise, match="seed is 0, not 1"):
        make_stream(job(2, seed=1), other)
    assert {path: path.read_bytes() for path in other.iterdir()} == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "mine", "other"]
    assert sorted(path.name for path in mine.iterdir()) == ["thesis.tex"]


def test_bad_requests_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(UnknownName, match="empty_space"):
        stream_named("kitchen")
    bad: list[dict[str, Any]] = [
        {"frames": 1},
        {"seed": -1},
        {"views": ("flow_forward",)},
        {"light": "newest"},
    ]
    for changes in [*bad, {"views": ("smell",)}]:
        with pytest.raises(InvalidRequest):
            job(**changes)
    assert main(["stream", "solid", "-o", str(tmp_path / "x"), "--laps", "0"]) == 2
    assert "--laps" in capsys.readouterr().err
    assert not (tmp_path / "x").exists()


def test_a_stream_in_the_background_hears_ctrl_c(tmp_path: Path) -> None:
    """A shell has what it puts into the background ignore it."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        assert main(["stream", "solid", "-o", str(tmp_path / "x"), "--laps", "0"]) == 2
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, before)


def test_the_command_writes_what_their_code_reads(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Bag, then folders of frames, motion and labels in pixels with y up."""
    bag, folder = tmp_path / "solid", tmp_path / "lve"
    words = ["stream", "solid", "--frames", "4", "-o", str(bag), "--backend", "native", "--quiet"]
    views = ["--views", "rgb", "instance", "flow"]
    assert main([*words, *views]) == 0
    assert "4 frames at 8 Hz" in capsys.readouterr().out
    assert main(["export", str(bag), "-o", str(folder), "--format", "lve"]) == 0
    assert json.loads((folder / "frames/fps.json").read_text()) == {"fps": 8.0}
    classes = json.loads((folder / "sup/map.json").read_text())
    assert classes == {"cube": 0, "sphere": 1, "cylinder": 2, "background": 3}
    motion = array(folder / "motion/00000001/004.bin")
    labels = array(folder / "sup/00000001/004.targets.bin").reshape(256, 256)
    moves = (motion != 0.0).any(axis=-1)
    assert moves.any()
    assert set(labels[moves]) == {classes["cylinder"]}
    for first, second in itertools.pairwise(sorted((folder / "frames/00000001").iterdir())):
        assert first.read_bytes() != second.read_bytes()
