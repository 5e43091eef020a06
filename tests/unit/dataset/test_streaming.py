"""Frames of a recipe without files: those that files would hold, and nothing left behind."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from sailenv_ros import dataset
from sailenv_ros.dataset import DatasetFrame, engine_of, load_job, make_dataset
from sailenv_ros.errors import InvalidRequest, RecordingError, SailenvError, UnknownName
from tests.unit.dataset.conftest import written_recipe
from tests.unit.frame.test_travelling_frames import require_equal


@pytest.fixture(scope="module")
def recipe(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A recipe of two cameras; its data set lies beside it."""
    folder = tmp_path_factory.mktemp("stream")
    path = written_recipe(folder, formats=["webdataset"], light="plain", amodal=True)
    make_dataset(load_job(path), folder / "made", engine_of(1, None))
    return path


@pytest.fixture
def nothing_left() -> Iterator[None]:
    """Nothing is left behind: no process and no thread; other things are not used."""

    def there() -> tuple[list[str], int]:
        threads = [one.name for one in threading.enumerate() if one.name == "sailenv-stream"]
        return threads, len(multiprocessing.active_children())

    before = there()
    yield
    assert there() == before


def same(one: DatasetFrame, other: DatasetFrame) -> None:
    for name in ("number", "split", "clip", "time", "camera"):
        assert getattr(one, name) == getattr(other, name)
    assert one.objects == other.objects
    require_equal(one.frame, other.frame)


@pytest.mark.usefixtures("nothing_left")
@pytest.mark.parametrize("split", ["", "val"])
def test_a_stream_gives_what_the_files_hold(recipe: Path, split: str) -> None:
    """Every frame, with its objects, in the order of the files, as often as it is asked for."""
    stream = dataset.stream(recipe, split)
    with dataset.open(recipe.parent / "made", split) as made:
        for _ in range(2):
            streamed = list(stream)
            assert len(streamed) == len(made)
            for one, other in zip(streamed, made, strict=True):
                same(one, other)


@pytest.mark.usefixtures("nothing_left")
def test_several_workers_give_the_same_frames(recipe: Path) -> None:
    """In an order that is the same each time."""
    first = list(dataset.stream(recipe, workers=3, ahead=1))
    again = [one.number for one in dataset.stream(recipe, workers=3, ahead=5)]
    assert [one.number for one in first] == again
    with dataset.open(recipe.parent / "made") as made:
        for one, other in zip(sorted(first, key=lambda one: one.number), made, strict=True):
            same(one, other)


@pytest.mark.parametrize("workers", [1, 2])
@pytest.mark.usefixtures("nothing_left")
def test_whoever_takes_a_few_frames_leaves_nothing(recipe: Path, workers: int) -> None:
    stream = iter(dataset.stream(recipe, workers=workers, ahead=2))
    next(stream)
    stream.close()  # type: ignore[attr-defined]  # a generator


def test_a_worker_is_ahead_by_so_many_frames(recipe: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Until they are taken it waits."""
    from sailenv_ros.dataset import frame_lines

    made: list[int] = []
    plain = frame_lines.told_objects

    def counted(*arguments: Any) -> Any:
        made.append(1)
        return plain(*arguments)

    monkeypatch.setattr(frame_lines, "told_objects", counted)
    line = frame_lines.FrameLine(load_job(recipe), [0], ahead=2)
    try:
        deadline = time.monotonic() + 30.0
        while not line._waiting.full() and time.monotonic() < deadline:
            time.sleep(0.01)
        assert line._waiting.full()
        taken = iter(line)
        next(taken)
        assert len(made) < 10 < 2 * 3 * 2
    finally:
        line.close()
    assert not line._thread.is_alive()


def test_samples_are_those_of_the_data_set(recipe: Path) -> None:
    made = dataset.open(recipe.parent / "made", format="numpy")
    for one, other in zip(dataset.stream(recipe, format="numpy"), made, strict=True):
        assert list(one) == list(other)
        for name, value in one.items():
            assert (
                np.array_equal(value, other[name], equal_nan=value.dtype.kind == "f")
                if (isinstance(value, np.ndarray))
                else value == other[name]
            )


def test_workers_of_a_loader_share_the_work(recipe: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each frame comes once, whichever number of workers; the stream travels to them."""
    stream = pickle.loads(pickle.dumps(dataset.stream(recipe)))
    told = SimpleNamespace(get_worker_info=lambda: SimpleNamespace(id=worker, num_workers=3))
    monkeypatch.setitem(sys.modules, "torch.utils.data", told)  # type: ignore[arg-type]
    numbers: list[int] = []
    for worker in range(3):  # noqa: B007 - the lambda above reads it
        numbers += [one.number for one in stream]
    assert sorted(numbers) == list(range(42))


@pytest.mark.usefixtures("nothing_left")
def test_errors_of_workers_reach_the_caller(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A scene that cannot be built, by a thread and by processes."""
    eye = {"type": "agent", "name": "eye", "width": 48, "height": 48}
    job = load_job(written_recipe(tmp_path, cameras=[eye], formats=["webdataset"]))
    # The check of the file would tell of it.
    wrong = job.recipe.cameras[0].model_copy(update={"agent": "nobody"})
    job = replace(job, recipe=job.recipe.model_copy(update={"cameras": (wrong,)}))
    for workers in (1, 2):
        with pytest.raises(UnknownName, match="nobody"):
            list(dataset.stream(job, workers=workers))


@pytest.mark.usefixtures("nothing_left")
def test_a_worker_that_is_killed_is_one_sentence(recipe: Path) -> None:
    stream = iter(dataset.stream(recipe, workers=2, ahead=1))
    next(stream)
    victim = multiprocessing.active_children()[0].pid
    assert victim is not None
    os.kill(victim, signal.SIGKILL)
    with pytest.raises(RecordingError, match="use fewer workers"):
        list(stream)


@pytest.mark.parametrize(
    ("settings", "error"),
    [
        ({"split": "test"}, UnknownName), ({"format": "jpeg"}, UnknownName),
        ({"workers": 0}, InvalidRequest), ({"ahead": 0}, InvalidRequest),
    ],
)  # fmt: skip
def test_what_makes_no_sense_is_refused(
    recipe: Path, settings: dict[str, Any], error: type[SailenvError]
) -> None:
    with pytest.raises(error):
        dataset.stream(recipe, **settings)


PROGRAM = """
import sys
from sailenv_ros import dataset
if __name__ == "__main__":
    for number, one in enumerate(dataset.stream(sys.argv[1], workers=2)):
        print("frame", flush=True)
        sys.stdin.readline()
"""


def is_there(group: int) -> bool:
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True


def test_ctrl_c_ends_all(recipe: Path, tmp_path: Path) -> None:
    """As a terminal sends it, to the whole group of processes: none of them is left."""
    program = tmp_path / "program.py"
    program.write_text(PROGRAM)
    with subprocess.Popen(
        [sys.executable, program, recipe],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as child:
        assert child.stdout is not None
        assert child.stdout.readline() == "frame\n"
        os.killpg(child.pid, signal.SIGINT)
        _, errors = child.communicate(timeout=60.0)
        assert "KeyboardInterrupt" in errors
        # Python's own tracker of resources ends when it sees that its parent has.
        deadline = time.monotonic() + 60.0
        while is_there(child.pid):
            assert time.monotonic() < deadline, "a process of the group is left"
            time.sleep(0.05)


def test_frames_are_made_without_ros(recipe: Path) -> None:
    """Where rclpy cannot be imported, as beside PyTorch in an environment of its own."""
    program = (
        "import sys; sys.modules['rclpy'] = None\n"
        "from sailenv_ros import dataset\n"
        f"print(next(iter(dataset.stream({str(recipe)!r}))).number)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=100, check=False
    )
    assert done.stdout == "0\n", done.stderr
