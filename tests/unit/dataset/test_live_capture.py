"""Data sets of a simulation that runs: which frames, with which facts, until when."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from sailenv_ros import AgentSpec, CameraIntrinsics, Simulation
from sailenv_ros.dataset import live_capture
from sailenv_ros.dataset.formats.dataset_format import Sample, WriteResult
from sailenv_ros.dataset.formats.vqa import VqaExport
from sailenv_ros.dataset.live_capture import LiveCapture
from sailenv_ros.errors import InvalidState

SMALL = CameraIntrinsics(width=64, height=48)


@pytest.fixture(scope="module")
def running() -> Iterator[Simulation]:
    """A simulation in real time."""
    with Simulation("optical", agent=AgentSpec(name="eye", intrinsics=SMALL)) as simulation:
        yield simulation


def test_frames_come_as_often_as_is_asked(running: Simulation, tmp_path: Path) -> None:
    told: list[int] = []
    begun_ns = running.sim_time_ns
    count = LiveCapture().write(
        running, tmp_path, "png", agent="eye", frames=3, rate_hz=20.0,
        stopped=threading.Event(), on_frame=told.append,
    )  # fmt: skip
    assert (count, told) == (3, [1, 2, 3])
    frames = json.loads((tmp_path / "frames.json").read_text())
    for number, frame in enumerate(frames):
        assert frame["stamp_ns"] >= begun_ns + 50e6 * number


def test_facts_are_of_the_instant_of_their_frame(
    running: Simulation, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    samples: list[Sample] = []

    def take(_: VqaExport, sample: Sample) -> WriteResult:
        samples.append(sample)
        return WriteResult(record={"questions": [], "referring": []})

    monkeypatch.setattr(VqaExport, "add", take)
    LiveCapture().write(
        running, tmp_path, "vqa", agent="eye", frames=2, rate_hz=30.0, stopped=threading.Event()
    )
    assert len(samples) == 2
    for sample in samples:
        assert sample.frame.facts is not None
        assert sample.frame.facts.sim_time_ns == sample.frame.stamp_ns
        assert "albedo" in sample.frame  # colours are asked for


def test_a_capture_ends_where_time_stands(
    running: Simulation, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What was seen until then is kept."""
    monkeypatch.setattr(live_capture, "STANDS_S", 0.1)
    monkeypatch.setattr(live_capture, "LOOK_S", 0.05)
    try:
        count = LiveCapture().write(
            running, tmp_path, "png", agent="eye", frames=3, rate_hz=0.1,
            stopped=threading.Event(), on_frame=lambda _: running.pause(),
        )  # fmt: skip
    finally:
        running.resume()
    assert count == 1
    assert (tmp_path / "export.json").is_file()


def test_what_is_stopped_before_it_began_is_refused(running: Simulation, tmp_path: Path) -> None:
    stopped = threading.Event()
    stopped.set()
    with pytest.raises(InvalidState, match="stopped before its first frame"):
        LiveCapture().write(
            running, tmp_path, "png", agent="eye", frames=3, rate_hz=20.0, stopped=stopped
        )
