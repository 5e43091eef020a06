"""Judges streams without an end by programs of others: river, PyTorch, avalanche.

    python benchmarks/judge_streams.py seek [--frames N]
    python benchmarks/judge_streams.py loader [--frames N] [--workers N]
    python benchmarks/judge_streams.py avalanche [--experiences N]
    python benchmarks/judge_streams.py drift [--seed N] [--habit NAME]
    python benchmarks/judge_streams.py still [--frames N] [--seed N] [--habit NAME]
    python benchmarks/judge_streams.py memory [--course NAME] [--begin N] [--frames N] [--seed N]
        [--episodes N]

`seek` plays a part of `home` through, makes random frames of it in another process by their
numbers, and compares all bytes. `loader` reads through `torch.utils.data.DataLoader`, in order and
shuffled. `avalanche` trains its `Naive` on experiences that are made when they are asked for.
`drift` gives simple statistics of frames to river's ADWIN as they come, see `SIGNALS`: a camera
that walks, or stands, in one room, one drift at a time, which begins at a frame. `still` does so
without any drift. ADWIN makes a test each 32 frames; its `delta`, the share of false alarms, is
divided by the number of tests of all statistics in 100,000 frames (Bonferroni). `memory` makes two
frames of each episode of `home`, or of the first few in each room, and tells the memory of the
process after each room, and mean and most of each tour through all rooms that begins after 10,000
frames; then those of the last tour in another process, which has not played the ones before.

Needed are `river`, `torch` and `avalanche-lib` beside this project, in an environment of their own.
"""

from __future__ import annotations

import argparse
import contextlib
import hashlib
import importlib
import multiprocessing
import resource
import sys
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml

import sailenv_ros.streams as streams
from sailenv_ros.streams.plan import HABITS
from sailenv_ros.system.memory import keep_freed_memory

SEED = 11
FIRST = 812_000
"""Where the parts begin that are looked at: all drifts of `home` are under way."""

ONSET, BEFORE, AFTER = 20_000, 5_000, 1_500
WARM_FRAMES = 10_000
"""Memory is compared with that after so many frames of a stream."""

WITHIN = 1_000
"""A drift is found if ADWIN tells it within so many frames of its onset."""

APPEARS = "bathtub"

SIGNALS = ("red", "green", "blue", "red / blue", APPEARS)
"""Mean colours of a picture, and the share of its pixels that are of the category."""

CLOCK, FRAMES = 32, 100_000
DELTA = 0.002 / (FRAMES / CLOCK * len(SIGNALS))
"""ADWIN's own settings are 32 and 0.002."""

PLAIN: dict[str, Any] = {
    "version": 1,
    "rate": 25,
    "episode": 500,
    "visit": 1,
    "rooms": {"scenes": ["room_03"]},
    "eye": {
        "width": 64, "height": 64,
        "picture": {"smooth_edges": False, "full_well": 4000, "read_noise": 3},
    },
    "moves": {"open": 2, "pushed": 3},
}  # fmt: skip


def _sensor(setting: str, begin: float, end: float, over: int = 0) -> dict[str, Any]:
    change = {"setting": setting, "onset": ONSET, "over": over, "begin": begin, "end": end}
    return {"sensor": [change]}


DRIFTS: dict[str, dict[str, Any]] = {
    "paint": {"paint": {"onset": ONSET, "every": 1_000_000}},
    "lamps": {"lamps": {"onset": ONSET, "life": 1000, "left": 0.2}},
    "gain": _sensor("gain", 0.0, 0.5),
    "white_balance": _sensor("white_balance", 0.0, 30.0),
    "dirt": _sensor("dirt", 0.0, 0.6, over=500),
    "vignetting": _sensor("vignetting", 0.0, 1.0),
    "wear": {"wear": {"onset": ONSET - 1, "over": 1, "most": 1}},
    "mount": {"mount": {"onset": ONSET, "every": 1_000_000, "turn": 15, "shift": 0.1, "zoom": 0.3}},
    "classes": {"classes": [{"category": APPEARS, "begin": ONSET}]},
}
"""One drift each, from `ONSET` on."""


def main() -> None:
    """Judge."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    actions = parser.add_subparsers(dest="action", required=True)
    seek = actions.add_parser("seek")
    seek.add_argument("--frames", type=int, default=200)
    loader = actions.add_parser("loader")
    loader.add_argument("--frames", type=int, default=2000)
    loader.add_argument("--workers", type=int, default=2)
    avalanche = actions.add_parser("avalanche")
    avalanche.add_argument("--experiences", type=int, default=10)
    drift = actions.add_parser("drift")
    still = actions.add_parser("still")
    memory = actions.add_parser("memory")
    memory.add_argument("--course", default="home", help="`still_home` has no drift")
    memory.add_argument("--begin", type=int, default=0)
    memory.add_argument("--frames", type=int, default=410_000)
    memory.add_argument("--episodes", type=int, default=8)
    for action in (drift, still, memory):
        action.add_argument("--seed", type=int, default=SEED)
    for action in (drift, still):
        action.add_argument("--habit", choices=HABITS, default="walk")
    still.add_argument("--frames", type=int, default=FRAMES)
    options = parser.parse_args()
    if options.action == "seek":
        judge_seeking(options.frames)
    elif options.action == "loader":
        judge_loader(options.frames, options.workers)
    elif options.action == "avalanche":
        judge_avalanche(options.experiences)
    elif options.action == "drift":
        judge_drift(options.seed, options.habit)
    elif options.action == "still":
        judge_stillness(options.frames, options.seed, options.habit)
    else:
        measure_memory(
            options.course, options.begin, options.frames, options.seed, options.episodes
        )


def judge_seeking(count: int) -> None:
    """Compare frames that were played through with the same ones by their numbers."""
    spread = 20 * count
    numbers = np.sort(np.random.default_rng(SEED).choice(spread, count, replace=False)) + FIRST
    wanted = set(numbers.tolist())
    with streams.open("home", seed=SEED) as stream:
        played = {
            frame.number: digest_of(frame)
            for frame in stream[FIRST : FIRST + spread]
            if frame.number in wanted
        }
    mixed = np.random.default_rng(SEED + 1).permutation(numbers).tolist()
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        sought, seconds = pool.apply(_sought, (mixed,))
    same = sum(played[number] == sought[number] for number in played)
    print(
        f"{same} of {count} frames equal; by number {np.median(seconds):.2f} s (median),", end=" "
    )
    print(f"{max(seconds):.2f} s (longest)")


def _sought(numbers: Sequence[int]) -> tuple[dict[int, str], list[float]]:
    found, seconds = {}, []
    with streams.open("home", seed=SEED) as stream:
        for number in numbers:
            begin_s = time.monotonic()
            found[number] = digest_of(stream[number])
            seconds.append(time.monotonic() - begin_s)
    return found, seconds


def digest_of(frame: Any) -> str:
    """Return the SHA-256 of a frame's views, in hexadecimal digits."""
    digest = hashlib.sha256()
    for name, view in sorted(frame.views.items()):
        digest.update(name.encode() + np.ascontiguousarray(view).tobytes())
    return digest.hexdigest()


def judge_loader(count: int, workers: int) -> None:
    """Read through PyTorch's loader, in order and shuffled, and compare with the stream."""
    from torch.utils.data import DataLoader

    part = streams.open("home", seed=SEED, format="arrays")[FIRST : FIRST + count]
    with streams.open("home", seed=SEED)[FIRST : FIRST + 50] as plain:
        expected = {frame.number: frame["rgb"].copy() for frame in plain}
    for label, subset, shuffle in (("in order", part, False), ("shuffled", part[:200], True)):
        loader = DataLoader(subset, batch_size=16, num_workers=workers, shuffle=shuffle)
        begin_s, seen, equal = time.monotonic(), 0, 0
        for batch in loader:
            seen += len(batch["number"])
            for place, number in enumerate(batch["number"].tolist()):
                if number in expected:
                    equal += int((batch["rgb"][place].numpy() == expected[number]).all())
        rate = seen / (time.monotonic() - begin_s)
        print(f"{label}: {seen} frames, {rate:.0f} a second; {equal} of 50 compared are equal")


def judge_avalanche(count: int) -> None:
    """Train avalanche's `Naive` on experiences of 100 frames that are made when they are due."""
    import torch
    from avalanche.benchmarks import CLStream
    from avalanche.benchmarks.scenarios.dataset_scenario import DatasetExperience
    from avalanche.benchmarks.utils import as_classification_dataset
    from avalanche.models import SimpleCNN
    from avalanche.training.supervised import Naive

    keep_freed_memory(many_scenes=True)
    stream = streams.open("home", seed=SEED, views=("rgb", "category", "instance"))
    made = []

    def experiences() -> Iterator[Any]:
        for number in range(count):
            pictures, labels = [], []
            begin = FIRST + 1000 * number
            for frame in stream[begin : begin + 1000 : 10]:
                picture = torch.from_numpy(frame["rgb"][::4, ::4].copy())
                pictures.append(picture.permute(2, 0, 1).float() / 255.0)
                labels.append(int(np.bincount(frame["category"].reshape(-1)).argmax()))
            data: Any = torch.utils.data.TensorDataset(torch.stack(pictures), torch.tensor(labels))
            data.targets = labels
            made.append(number)
            yield DatasetExperience(dataset=as_classification_dataset(data))

    model = SimpleCNN(num_classes=512)
    strategy = Naive(
        model=model, optimizer=torch.optim.SGD(model.parameters(), lr=0.01),
        train_mb_size=10, train_epochs=1, evaluator=None,
    )  # fmt: skip
    for experience in CLStream("train", experiences()):
        strategy.train(experience)
        most_mib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        print(f"experience {experience.current_experience}: {len(made)} made, {most_mib:.0f} MiB")


def judge_drift(seed: int, habit: str) -> None:
    """Tell what river's ADWIN finds of each drift."""
    for name, drift in DRIFTS.items():
        signals = _signals({**_plain(habit), "drift": drift}, seed, ONSET - BEFORE, ONSET + AFTER)
        found = {
            signal: [place - BEFORE for place in _changes(values)]
            for signal, values in signals.items()
        }
        first = min(
            (place for places in found.values() for place in places if place >= 0), default=None
        )
        early = sum(place < 0 for places in found.values() for place in places)
        told = "not found" if first is None or first > WITHIN else f"found after {first} frames"
        print(f"{name}: {told}; {early} before; {found}", flush=True)


def judge_stillness(count: int, seed: int, habit: str) -> None:
    """Tell what river's ADWIN finds where nothing drifts, after every 10,000 frames."""
    detectors = {signal: _detector() for signal in SIGNALS}
    found: dict[str, list[int]] = {signal: [] for signal in detectors}
    for begin in range(0, count, 10_000):
        end = min(count, begin + 10_000)
        signals = _signals(_plain(habit), seed, begin, end)
        for signal, detector in detectors.items():
            for place, value in enumerate(signals[signal].tolist(), start=begin):
                detector.update(value)
                if detector.drift_detected:
                    found[signal].append(place)
        print(f"{end} frames without drift: {found}", flush=True)


def measure_memory(course: str, begin: int, count: int, seed: int, episodes: int) -> None:
    """Print the memory of this process after each room, of whose frames few are made.

    Rooms differ, and change with the stream. So at the end another process makes the frames of the
    last tour alone: what it needs less is what this one kept of all before. It finds on disk what
    this one had to make, for which modules were needed, so it begins by importing all of this one.
    """
    tours: dict[int, list[_RoomMemory]] = {}
    for one in _rooms_memory(course, begin, count, seed, episodes):
        told = f"{one.own:.0f} MiB of its own, {one.own_most:.0f} at most"
        print(f"frame {one.left}: {told}; {one.all:.0f} with files, {one.most:.0f} at most")
        if one.entered >= begin + WARM_FRAMES:
            tours.setdefault((one.entered - begin - WARM_FRAMES) // one.tour, []).append(one)
            words = ", ".join(_told(rooms) for rooms in tours.values())
            print(f"its own: mean / most after a room / ever, by tour: {words} MiB", flush=True)
    if len(tours) < 2:
        return
    rooms = [one for rooms in tours.values() for one in rooms]
    played = [one for one in rooms if one.left > rooms[-1].left - one.tour]
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        fresh = pool.apply(
            _list_of_rooms, (sorted(sys.modules), course, played[0].entered, count, seed, episodes)
        )
    for how, made in (("played through", played), ("by itself", fresh)):
        print(f"the last tour {how}: {_told(made)} MiB")


@dataclass(frozen=True, kw_only=True)
class _RoomMemory:
    """Memory of this process after a room of a stream, and the most while it was made [MiB].

    Frames are those with which it is entered and left, and as many as a tour through all takes.
    """

    entered: int
    left: int
    tour: int
    own: float
    own_most: float
    all: float
    most: float


def _rooms_memory(
    course: str, begin: int, end: int, seed: int, episodes: int
) -> Iterator[_RoomMemory]:
    keep_freed_memory(many_scenes=True)
    with streams.open(course, seed=seed) as stream, _MostOwn() as most_own:
        episode = stream.course.episode
        stay = episode * stream.course.visit
        for entered in range(begin // stay * stay, end, stay):
            forget_peak()
            for first in range(entered, entered + stay, episode)[:episodes]:
                for number in (first, first + 2):
                    stream[number]
            own, all_mib, most = (memory_mib(one) for one in ("RssAnon", "VmRSS", "VmHWM"))
            yield _RoomMemory(
                entered=entered, left=entered + stay, tour=stay * len(stream.rooms),
                own=own, own_most=most_own.taken(), all=all_mib, most=most,
            )  # fmt: skip


def _list_of_rooms(
    modules: Sequence[str], course: str, begin: int, end: int, seed: int, episodes: int
) -> list[_RoomMemory]:
    for name in modules:
        if name != "__main__":
            with contextlib.suppress(ImportError):  # of modules that others make as they run
                importlib.import_module(name)
    return list(_rooms_memory(course, begin, end, seed, episodes))


def _told(rooms: Sequence[_RoomMemory]) -> str:
    mean = sum(one.own for one in rooms) / len(rooms)
    most = max(one.own for one in rooms), max(one.own_most for one in rooms)
    return f"{mean:.0f} / {most[0]:.0f} / {most[1]:.0f}"


class _MostOwn:
    """The most memory of its own that this process has had; a context manager."""

    def __init__(self) -> None:
        self._most, self._ends = 0.0, threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)

    def _watch(self) -> None:
        while not self._ends.wait(0.01):
            self._most = max(self._most, memory_mib("RssAnon"))

    def taken(self) -> float:
        """Return the most since this was asked before [MiB]."""
        most, self._most = self._most, 0.0
        return most

    def __enter__(self) -> _MostOwn:
        self._thread.start()
        return self

    def __exit__(self, *exc: object) -> None:
        self._ends.set()
        self._thread.join()


def memory_mib(entry: str) -> float:
    """Return an entry of this process's ``/proc/self/status`` [MiB].

    Parameters
    ----------
    entry : str
        ``RssAnon`` is its own memory, ``VmRSS`` that and the pages of files that it has mapped,
        which all processes share and the system may take back at any time, and ``VmHWM`` the
        greatest ``VmRSS`` since `forget_peak`.
    """
    entries = dict(
        line.split(":", 1) for line in Path("/proc/self/status").read_text().splitlines()
    )
    return int(entries[entry].split()[0]) / 1024


def forget_peak() -> None:
    """Have the greatest memory of this process be that of now."""
    Path("/proc/self/clear_refs").write_text("5")


def _plain(habit: str) -> dict[str, Any]:
    """Return the course without drift, for a camera of one habit."""
    habits = {name: float(name == habit) for name in HABITS}
    return {**PLAIN, "eye": {**PLAIN["eye"], **habits}}


def _signals(course: dict[str, Any], seed: int, begin: int, end: int) -> dict[str, np.ndarray]:
    """Return simple statistics of frames, from 0 to 1 each: see `SIGNALS`."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "course.yaml"
        path.write_text(yaml.safe_dump(course))
        with streams.open(path, seed=seed, views=("rgb", "category")) as stream:
            told = [(frame["rgb"].mean(axis=(0, 1)), _share(frame)) for frame in stream[begin:end]]
    red, green, blue = np.array([colours for colours, _ in told]).T / 255.0
    values = red, green, blue, red / blue / 4.0, np.array([share for _, share in told])
    return dict(zip(SIGNALS, values, strict=True))


def _share(frame: streams.StreamFrame) -> float:
    """Return the share of pixels that are of the category that appears."""
    info = frame.frame.info
    assert info is not None
    return float((frame["category"] == info.categories.named(APPEARS).id).mean())


def _changes(values: np.ndarray) -> list[int]:
    detector, found = _detector(), []
    for place, value in enumerate(values.tolist()):
        detector.update(value)
        if detector.drift_detected:
            found.append(place)
    return found


def _detector() -> Any:
    from river.drift import ADWIN

    return ADWIN(delta=DELTA, clock=CLOCK)


if __name__ == "__main__":
    main()
