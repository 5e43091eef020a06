"""Samples of data sets as trainers take them, by processes that are forked or spawned."""

from __future__ import annotations

import json
import multiprocessing
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sailenv_ros import dataset
from sailenv_ros.dataset import engine_of, frame_sources, load_job, make_dataset
from sailenv_ros.dataset.frame_sources import _without_objects
from sailenv_ros.dataset.samples import sample_of
from sailenv_ros.errors import MissingPackage, RecordingError, UnknownName
from tests.unit.dataset.conftest import written_recipe
from tests.unit.frame.test_travelling_frames import require_equal

VIEWS = ["rgb", "depth", "category", "instance", "flow"]
BESIDE = ["K", "world_from_camera", "number", "clip", "time", "stamp_ns", "dt_ns"]
TEXTS = ["split", "camera", "scene"]

CAMERAS = [
    {
        "type": "orbit", "name": "around", "object": "red cube", "width": 64, "height": 48,
        "distance": [4.0, 5.0], "turn": [20.0, 40.0],
    }
]  # fmt: skip


@pytest.fixture(scope="module", params=["webdataset", "mcap"])
def folder(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a data set of one camera, in each of the formats that are read."""
    here = tmp_path_factory.mktemp("samples")
    recipe = written_recipe(here, cameras=CAMERAS, formats=[request.param], light="plain")
    make_dataset(load_job(recipe), here / "made", engine_of(1, None))
    return here / "made"


def collated(samples: list[Any]) -> Any:
    """Make a batch by the rules of PyTorch's `default_collate`, and refuse what it refuses."""
    first = samples[0]
    if isinstance(first, np.ndarray):
        assert first.dtype.kind in "biuf", first.dtype
        assert all(one.flags.writeable for one in samples), "as_tensor warns of it"
        assert {one.dtype for one in samples} == {first.dtype}
        return np.stack(samples)
    if type(first) is int or type(first) is float:
        return np.array(samples)
    if type(first) is str:
        return samples
    assert type(first) is dict, type(first)
    assert all(list(one) == list(first) for one in samples)
    return {name: collated([one[name] for one in samples]) for name in first}


def worked(samples: Any, numbers: list[int]) -> Any:
    """Return a batch, as a worker of a loader makes it."""
    return collated([samples[number] for number in numbers])


def work(samples: Any, numbers: list[int], answers: Any) -> None:
    """Send a batch from a worker that got the samples with its start."""
    try:
        answers.put((numbers[0], worked(samples, numbers)))
    except BaseException as error:
        answers.put((numbers[0], error))


def batches_by(method: str, samples: Any, numbers: list[list[int]]) -> Iterator[Any]:
    """Yield batches that four workers make at once, in order."""
    context = multiprocessing.get_context(method)
    answers = context.Queue()
    workers = [
        context.Process(target=work, args=(samples, some, answers), daemon=True) for some in numbers
    ]
    for worker in workers:
        worker.start()
    found = dict(answers.get(timeout=60) for _ in workers)
    for worker in workers:
        worker.join(10)
    for some in numbers:
        batch = found[some[0]]
        if isinstance(batch, BaseException):
            raise batch
        yield batch


@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_workers_make_batches_of_what_the_frames_hold(folder: Path, method: str) -> None:
    """The data set was opened and read before: forks had its files, and their places in them."""
    with dataset.open(folder) as frames, dataset.open(folder, format="numpy") as samples:
        assert len(samples) == len(frames) == 21
        assert samples[0]["number"] == frames[0].number
        numbers = [list(range(first, 21, 4)) for first in range(4)]
        for some, batch in zip(numbers, batches_by(method, samples, numbers), strict=True):
            assert list(batch) == [*VIEWS, *BESIDE, *TEXTS]
            for row, number in enumerate(some):
                one = frames[number]
                for view, values in one.frame.items():
                    wide = np.uint16 if view == "category" else values.dtype
                    assert batch[view].dtype == wide
                    np.testing.assert_array_equal(batch[view][row], values)
                told = [batch[name][row] for name in BESIDE[2:]]
                assert told == [
                    one.number, one.clip, one.time, one.frame.stamp_ns, one.frame.dt_ns
                ]  # fmt: skip
                assert [batch[name][row] for name in TEXTS] == [one.split, "around", "optical"]
                camera = one.frame.camera
                np.testing.assert_array_equal(batch["K"][row], camera.intrinsics.K)
                np.testing.assert_array_equal(
                    batch["world_from_camera"][row], camera.world_from_camera
                )


def test_threads_read_at_once(small: Path) -> None:
    """None of them moves another one's place in a tar file."""
    with dataset.open(small) as frames:
        wanted = [frames[number].frame["depth"].tobytes() for number in range(len(frames))]

        def read(step: int) -> list[bytes]:
            numbers = (step * n % len(frames) for n in range(len(frames)))
            return [frames[number].frame["depth"].tobytes() for number in numbers]

        steps = (1, 5, 11, 17)
        with ThreadPoolExecutor(len(steps)) as threads:
            for step, found in zip(steps, threads.map(read, steps), strict=True):
                assert found == [wanted[step * n % len(frames)] for n in range(len(frames))]


def test_frames_of_a_data_set_go_to_other_processes(folder: Path) -> None:
    """`DatasetFrame` too, with everything that it holds."""
    with dataset.open(folder) as frames:
        one = frames[4]
        with multiprocessing.get_context("spawn").Pool(1) as pool:
            back = pool.apply_async(np.array, ([one], object)).get(60)[0]
        require_equal(one, back)
        lines = repr(one).splitlines()
        assert len(lines) == 2
        assert lines[0].startswith(f"<DatasetFrame {one.number} of {one.split}: clip {one.clip}")


def test_slices_and_splits(folder: Path) -> None:
    with dataset.open(folder, "val", format="numpy") as val:
        assert len(val) == 6
        assert [one["split"] for one in val] == ["val"] * 6
        assert [one["time"] for one in val[::2]] == [0, 2, 1]
        assert val[-1]["number"] == val[5]["number"]


def test_what_cannot_be_had_is_said(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An unknown format, PyTorch where there is none, a frame that lacks a view."""
    with pytest.raises(UnknownName, match="format must be one of: frame, numpy, torch"):
        dataset.open(folder, format="tensorflow")  # type: ignore[call-overload]
    monkeypatch.setitem(sys.modules, "torch", None)
    with pytest.raises(MissingPackage, match=r"the format 'torch' needs torch.*pip install torch"):
        dataset.open(folder, format="torch")
    with dataset.open(folder, format="numpy") as samples:
        more = samples.dataset.recipe.model_copy(update={"views": (*VIEWS, "albedo")})
        samples.dataset.recipe = more
        with pytest.raises(RecordingError, match="frame 3 lacks albedo"):
            _ = samples[3]


def test_reading_tar_files_needs_no_ros() -> None:
    """Nor does it import what only bags need."""
    code = """
import sys
from sailenv_ros.dataset import opening
print([name for name in ("rclpy", "sailenv_msgs", "mcap", "torch") if name in sys.modules])
"""
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert told.stdout == "[]\n"


def test_a_record_of_chance_may_name_objects_too() -> None:
    """What is left out for speed is the frame's own list of objects, which comes last."""
    record = {"randomised": {"frame": {"x": 1, "objects": [{"id": 7}]}}, "scene": ', "objects": ['}
    written = json.dumps({**record, "objects": [{"id": 1, "name": ', "objects": ['}]}).encode()
    assert _without_objects(written) == record
    # Of a longer record the beginning alone is read first.
    assert _without_objects(written[: written.rindex(b', "objects": [')]) is None
    assert _without_objects(json.dumps(record).encode()) is None


def test_a_long_record_is_read_whole(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with dataset.open(folder, format="numpy") as samples:
        wanted = samples[2]
        monkeypatch.setattr(frame_sources, "_HEAD_BYTES", 50)
        found = samples[2]
    assert [found[name] for name in BESIDE[2:]] == [wanted[name] for name in BESIDE[2:]]


def test_a_sample_is_its_owners(folder: Path) -> None:
    """Who writes to its arrays changes no other one, and no frame that is read again."""
    with dataset.open(folder) as frames, dataset.open(folder, format="numpy") as samples:
        for one in (samples[0], samples[0]):
            for view, values in frames[0].frame.items():
                np.testing.assert_array_equal(one[view], values)
            for name in (*VIEWS, *BESIDE[:2]):
                one[name][:] = 1


def test_arrays_of_tar_files_are_not_copied(small: Path) -> None:
    """Neither from the file's bytes nor for the sample."""
    with dataset.open(small) as frames:
        one = frames.frame_at(0, objects=False)
        sample = sample_of(one, ["rgb", "depth"], "numpy", small, copy=frames.keeps_arrays)
        for view in ("rgb", "depth"):
            assert np.shares_memory(sample[view], one.frame[view])
