"""Frames → LeRobot v3: episodes of what a camera saw, where it was, and where it went next.

The layout is that of https://huggingface.co/docs/lerobot/lerobot-dataset-v3 with images in the
tables. An episode is a clip of a data set, or an epoch of a recording. ``observation.state`` is the
camera's pose, ``action`` that of the next frame (the last repeats its own), both x, y, z [m] and
a unit quaternion x, y, z, w. Depth is exact: 32-bit numbers [m].
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from itertools import pairwise
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.dataset.formats.data_files import discard_drafts, write_bytes, write_json
from sailenv_ros.dataset.formats.dataset_format import DatasetFormat, Record, Sample, WriteResult
from sailenv_ros.dataset.formats.row_tables import RowTable
from sailenv_ros.errors import RecordingError
from sailenv_ros.extras import need
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.pictures.codecs import encode_png

__all__ = ["LeRobotExport"]

VERSION = "v3.0"
FILES_PER_CHUNK = 1000
TASK = "look around"
IMAGE, DEPTH, STATE, ACTION = (
    "observation.images.camera", "observation.depth", "observation.state", "action"
)  # fmt: skip
POSE_NAMES = ("x", "y", "z", "qx", "qy", "qz", "qw")
COUNTERS = ("timestamp", "frame_index", "episode_index", "index", "task_index")


class LeRobotExport(DatasetFormat):
    """``data/chunk-000/file-000.parquet`` and ``meta``; of a split data set one folder holds all.

    Frames must come one episode after another, so of one camera.
    """

    views: ClassVar[tuple[str, ...]] = ("rgb",)
    is_shard: ClassVar[bool] = True
    needs_records: ClassVar[bool] = True
    of_one_camera: ClassVar[bool] = True
    needs_neighbours: ClassVar[bool] = True
    resumable: ClassVar[bool] = False
    packages: ClassVar[tuple[str, ...]] = ("pyarrow",)

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self._arrow: Any = need("pyarrow", "the format lerobot")
        self._parquet: Any = need("pyarrow.parquet", "the format lerobot")
        self._open = ExitStack()
        self._table: RowTable | None = None
        self._epochs: list[int] = []

    def add(self, sample: Sample) -> WriteResult:
        """Append a frame."""
        frame = sample.frame
        episode = self._episode(sample)
        begins = sample.previous is None or not _of_one_episode(frame, sample.previous)
        following = sample.following
        goes_on = following is not None and _of_one_episode(frame, following)
        now, then = _pose(frame), _pose(following if goes_on and following else frame)
        row = {
            IMAGE: {"bytes": encode_png(frame["rgb"], "fastest"), "path": None},
            STATE: now.tolist(),
            ACTION: then.tolist(),
            "episode_index": episode,
            "index": sample.number,
            "task_index": 0,
            # Both are set when the episode's beginning is known.
            "timestamp": frame.stamp_ns,
            "frame_index": 0 if begins else -1,
        }
        if "depth" in frame.views:
            row[DEPTH] = list(frame["depth"])
        self._count(row)
        if self._table is None:
            self._table = self._begun(frame)
        self._table.append(row)
        return WriteResult(record=self._record(sample, episode, now, then), written={"frames": 1})

    def finish(self, records: Sequence[Record]) -> None:
        """Close the table, and write what is known of all episodes."""
        if self._table is not None:
            self._table.finish()
            self._table = None
        self._open.close()
        if records:
            self._write_meta(records)

    def close(self) -> None:
        """Remove what is not complete."""
        self._table = None
        discard_drafts(self._open)

    # -- the tables of frames ----------------------------------------------------------------

    def _episode(self, sample: Sample) -> int:
        if sample.sequence_number is not None:
            return sample.sequence_number - 1
        if sample.frame.epoch not in self._epochs:
            self._epochs.append(sample.frame.epoch)
        return self._epochs.index(sample.frame.epoch)

    def _count(self, row: dict[str, Any]) -> None:
        """Set a row's place and time in its episode."""
        if row["frame_index"] == 0:
            self._first_ns, self._frame_index = row["timestamp"], 0
        else:
            self._frame_index += 1
        row["frame_index"] = self._frame_index
        row["timestamp"] = (row["timestamp"] - self._first_ns) * 1e-9

    def _begun(self, frame: Frame) -> RowTable:
        pa = self._arrow
        columns = {
            IMAGE: pa.struct({"bytes": pa.binary(), "path": pa.string()}),
            STATE: pa.list_(pa.float32(), len(POSE_NAMES)),
            ACTION: pa.list_(pa.float32(), len(POSE_NAMES)),
            "timestamp": pa.float32(),
            **{name: pa.int64() for name in COUNTERS[1:]},
        }
        if "depth" in frame.views:
            columns[DEPTH] = pa.list_(pa.list_(pa.float32()))
        path = self.folder / "data" / f"{_file_of(self.part)}.parquet"
        return RowTable(self._open, path, pa.schema(list(columns.items())))

    # -- what is known of all ----------------------------------------------------------------

    def _record(
        self, sample: Sample, episode: int, now: NDArray[np.float32], then: NDArray[np.float32]
    ) -> dict[str, Any]:
        frame = sample.frame
        rgb = frame["rgb"].reshape(-1, 3) / 255.0
        numbers: dict[str, NDArray[Any]] = {STATE: now[None], ACTION: then[None], IMAGE: rgb}
        if "depth" in frame.views:
            numbers[DEPTH] = frame["depth"].reshape(-1, 1)
        return {
            "episode": episode,
            "part": self.part,
            "time": self._frame_index,
            "stamp_ns": frame.stamp_ns,
            "size": list(frame["rgb"].shape[:2]),
            "depth": "depth" in frame.views,
            "sums": {name: _sums(values) for name, values in numbers.items()},
        }

    def _write_meta(self, records: Sequence[Record]) -> None:
        values = [record.value for record in records]
        sizes = {tuple(value["size"]) for value in values}
        if len(sizes) > 1:
            raise RecordingError(
                f"LeRobot needs pictures of one size, got {', '.join(map(str, sorted(sizes)))}"
            )
        height, width = sizes.pop()
        with_depth = values[0]["depth"]
        episodes = 1 + max(value["episode"] for value in values)
        lengths = [0] * episodes
        parts = [0] * episodes
        for value in values:
            lengths[value["episode"]] += 1
            parts[value["episode"]] = value["part"]
        ends = np.cumsum(lengths).tolist()
        rows = [
            {
                "episode_index": number,
                "tasks": [TASK],
                "length": length,
                "data/chunk_index": parts[number] // FILES_PER_CHUNK,
                "data/file_index": parts[number] % FILES_PER_CHUNK,
                "dataset_from_index": ends[number] - length,
                "dataset_to_index": ends[number],
                "meta/episodes/chunk_index": 0,
                "meta/episodes/file_index": 0,
            }
            for number, length in enumerate(lengths)
        ]
        self._write_table("meta/episodes/chunk-000/file-000", self._arrow.Table.from_pylist(rows))
        self._write_table("meta/tasks", self._tasks())
        write_json(self.folder / "meta" / "stats.json", _stats(values))
        info = {
            "codebase_version": VERSION,
            "robot_type": "camera",
            "total_episodes": episodes,
            "total_frames": len(values),
            "total_tasks": 1,
            "chunks_size": FILES_PER_CHUNK,
            "data_files_size_in_mb": 100,
            "video_files_size_in_mb": 200,
            "fps": _rate(values),
            "splits": _splits(records, episodes),
            "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
            "video_path": None,
            "features": _features(height, width, with_depth=with_depth),
        }
        write_json(self.folder / "meta" / "info.json", info)

    def _tasks(self) -> Any:
        """Return the table of tasks, whose names pandas takes for its index."""
        pa, index = self._arrow, "__index_level_0__"
        told = {
            "index_columns": [index],
            "column_indexes": [],
            "columns": [
                {"name": "task_index", "field_name": "task_index", "pandas_type": "int64",
                 "numpy_type": "int64", "metadata": None},
                {"name": None, "field_name": index, "pandas_type": "unicode",
                 "numpy_type": "object", "metadata": None},
            ],
        }  # fmt: skip
        schema = pa.schema(
            [("task_index", pa.int64()), (index, pa.string())],
            metadata={"pandas": json.dumps(told)},
        )
        return pa.Table.from_pylist([{"task_index": 0, index: TASK}], schema=schema)

    def _write_table(self, name: str, table: Any) -> None:
        sink = self._arrow.BufferOutputStream()
        self._parquet.write_table(table, sink)
        write_bytes(self.folder / f"{name}.parquet", sink.getvalue().to_pybytes())


def _of_one_episode(frame: Frame, other: Frame) -> bool:
    return (frame.scene, frame.epoch, frame.agent) == (other.scene, other.epoch, other.agent)


def _pose(frame: Frame) -> NDArray[np.float32]:
    pose = frame.camera.pose
    return np.array([*pose.position_m, *pose.orientation_xyzw], np.float32)


def _file_of(part: int) -> str:
    chunk, file = divmod(part, FILES_PER_CHUNK)
    return f"chunk-{chunk:03d}/file-{file:03d}"


def _sums(values: NDArray[Any]) -> list[Any]:
    """Return count, sums, sums of squares, least and greatest of each column; NaN is left out."""
    known = values[np.isfinite(values).all(axis=1)].astype(np.float64)
    if not len(known):
        return [0, *[[0.0] * values.shape[1]] * 2, None, None]
    return [
        len(known),
        known.sum(axis=0).tolist(),
        (known**2).sum(axis=0).tolist(),
        known.min(axis=0).tolist(),
        known.max(axis=0).tolist(),
    ]


def _stats(values: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Return mean, deviation, least and greatest of what trainers normalise."""
    found: dict[str, Any] = {}
    for name in values[0]["sums"]:
        parts = [value["sums"][name] for value in values if value["sums"][name][0]]
        if not parts:
            continue
        count = sum(part[0] for part in parts)
        mean = np.sum([part[1] for part in parts], axis=0) / count
        square = np.sum([part[2] for part in parts], axis=0) / count
        columns = {
            "min": np.min([part[3] for part in parts], axis=0),
            "max": np.max([part[4] for part in parts], axis=0),
            "mean": mean,
            "std": np.sqrt(np.maximum(square - mean**2, 0.0)),
        }
        # Of images: one number for each channel, as (C, 1, 1).
        shape = (-1, 1, 1) if name == IMAGE else (-1,)
        found[name] = {key: column.reshape(shape).tolist() for key, column in columns.items()}
        found[name]["count"] = [count]
    return found


def _rate(values: Sequence[Mapping[str, Any]]) -> int:
    """Return frames per second: what most steps within episodes say; 30 for single pictures."""
    steps = [
        later["stamp_ns"] - one["stamp_ns"]
        for one, later in pairwise(values)
        if one["episode"] == later["episode"]
    ]
    return max(1, round(1e9 / float(np.median(steps)))) if steps else 30


def _splits(records: Sequence[Record], episodes: int) -> dict[str, str]:
    """Return the range of episodes of each split, which follow one another."""
    found: dict[str, list[int]] = {}
    for record in records:
        found.setdefault(record.split or "train", []).append(record.value["episode"])
    bounds = {name: min(numbers) for name, numbers in found.items()}
    names = sorted(bounds, key=lambda name: bounds[name])
    begins = [0, *(bounds[name] for name in names[1:]), episodes]
    return {name: f"{begins[k]}:{begins[k + 1]}" for k, name in enumerate(names)}


def _features(height: int, width: int, *, with_depth: bool) -> dict[str, Any]:
    features: dict[str, Any] = {
        IMAGE: {
            "dtype": "image",
            "shape": [height, width, 3],
            "names": ["height", "width", "channels"],
        },
        STATE: {"dtype": "float32", "shape": [len(POSE_NAMES)], "names": list(POSE_NAMES)},
        ACTION: {"dtype": "float32", "shape": [len(POSE_NAMES)], "names": list(POSE_NAMES)},
    }
    for name in COUNTERS:
        dtype = "float32" if name == "timestamp" else "int64"
        features[name] = {"dtype": dtype, "shape": [1], "names": None}
    if with_depth:
        features[DEPTH] = {
            "dtype": "float32",
            "shape": [height, width],
            "names": ["height", "width"],
        }
    return features
