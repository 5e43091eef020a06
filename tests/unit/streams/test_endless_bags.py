"""Bags of an endless stream: its own frames, begun anywhere, whole after an interruption."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sailenv_ros.cli.main import main
from sailenv_ros.dataset.streams.endless import EndlessJob, make_endless
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.frame import Frame
from sailenv_ros.recording.frames import RecordedFrames
from sailenv_ros.recording.reader import RecordingReader
from sailenv_ros.streams import Course, Stream


def _frames(bag: Path) -> list[Frame]:
    with RecordingReader(bag) as reader:
        return list(RecordedFrames(reader, "eye"))


def _files(folder: Path) -> dict[str, bytes]:
    return {file.name.split("_")[-1]: file.read_bytes() for file in folder.glob("*.mcap")}


def test_a_bag_has_the_frames_of_the_stream(course: Course, stream: Stream, tmp_path: Path) -> None:
    job = EndlessJob(course=course, frames=9, begin=20, seed=5, part_frames=5)
    bag = make_endless(job, tmp_path / "bag")
    frames = _frames(bag)
    assert [frame.sequence for frame in frames] == list(range(20, 29))
    for frame in frames:
        made = stream[frame.sequence]
        for name, view in made.views.items():
            np.testing.assert_array_equal(frame.views[name], view)
        assert frame.stamp_ns == round(frame.sequence * 1e9 / 30)
        assert frame.randomised is not None
        told = frame.randomised["stream"]
        assert told["drift"]["daylight"]["values"] == made.drift["daylight"].values
        assert (told["room"], told["habit"]) == (made.room, made.habit)


def test_an_interrupted_bag_ends_with_the_same_bytes(course: Course, tmp_path: Path) -> None:
    job = EndlessJob(course=course, frames=13, begin=3, seed=5, part_frames=5)

    def stop(done: int) -> None:
        if done == 8:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        make_endless(job, tmp_path / "cut", on_frame=stop)
    assert not (tmp_path / "cut").exists()
    seen: list[int] = []
    whole = make_endless(job, tmp_path / "cut", on_frame=seen.append)
    assert seen == list(range(6, 14))
    assert _files(whole) == _files(make_endless(job, tmp_path / "whole"))
    assert len(_files(whole)) == 3


def test_several_processes_write_the_same_bytes_and_fill_gaps(
    course: Course, tmp_path: Path
) -> None:
    job = EndlessJob(course=course, frames=13, begin=3, seed=5, part_frames=5)
    whole = _files(make_endless(job, tmp_path / "whole"))
    seen: list[int] = []
    made = make_endless(job, tmp_path / "bag", workers=2, on_frame=seen.append)
    assert _files(made) == whole
    assert seen == sorted(seen)
    assert seen[-1] == 13
    # As if the worker of the second file had been killed.
    growing = made.rename(tmp_path / "bag.unfinished")
    (growing / "bag_1.mcap").unlink()
    (growing / "metadata.yaml").unlink()
    seen.clear()
    assert _files(make_endless(job, tmp_path / "bag", on_frame=seen.append)) == whole
    assert seen == list(range(9, 14))


def test_the_command_makes_one(course_file: Path, tmp_path: Path) -> None:
    arguments = [
        "--course",
        str(course_file),
        "--begin",
        "7",
        "--frames",
        "3",
        "--quiet",
        "--workers",
        "2",
    ]
    assert main(["stream", "endless", *arguments, "-o", str(tmp_path / "bag")]) == 0
    assert [frame.sequence for frame in _frames(tmp_path / "bag")] == [7, 8, 9]


def test_what_is_beyond_the_stream_is_refused(course: Course) -> None:
    with pytest.raises(InvalidRequest, match="frames"):
        EndlessJob(course=course, frames=2, begin=9_999_999)
    with pytest.raises(InvalidRequest, match="workers"):
        make_endless(EndlessJob(course=course, frames=2), "never", workers=0)
