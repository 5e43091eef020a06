"""Frames → videos that control a video model, with a caption, as NVIDIA's Cosmos Transfer has them.

``videos/``, ``metas/`` (captions), and a folder for each control: ``depth``, ``seg``, ``edge`` and
``vis`` (blurred). ``seg/`` has masks besides, for training; ``specs/`` what its inference reads,
from within the folder. A clip is what has one epoch.
"""

from __future__ import annotations

import json
import pickle
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.dataset.formats.data_files import write_bytes
from sailenv_ros.dataset.formats.dataset_format import DatasetFormat, Record, Sample, WriteResult
from sailenv_ros.dataset.formats.video_file import VideoFile
from sailenv_ros.dataset.formats.video_masks import VideoMasks
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.language import caption, scene_graph
from sailenv_ros.types.labels import colour_instances

__all__ = ["CosmosExport"]

Picture = NDArray[np.uint8]

NEAREST_M, FARTHEST_M = 0.4, 12.0
"""Depths that are white and black: inverse depth is linear between them, as estimators give it."""

CANNY = 100, 200
"""Thresholds of the edges."""

BLUR_SHARE = 0.02
"""Standard deviation of the blur, in heights of the picture."""


class CosmosExport(DatasetFormat):
    """``0000.mp4`` in ``videos`` and the controls' folders, and what is told of it.

    ``metas/0000.txt``, ``seg/0000.pickle``, ``specs/0000.json``.
    """

    views: ClassVar[tuple[str, ...]] = ("rgb", "depth", "instance")
    is_sequence: ClassVar[bool] = True
    resumable: ClassVar[bool] = False

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self._clip = -1
        self._epoch: int | None = None
        self._files: dict[str, VideoFile] = {}
        self._caption, self._masks = "", VideoMasks()
        self._phrases: dict[int, str] = {}

    def add(self, sample: Sample) -> WriteResult:
        """Add a frame to each video; the first of a clip is described."""
        frame, written = sample.frame, {"pictures": 1}
        if frame.epoch != self._epoch:
            self._end()
            self._clip, self._epoch = self._clip + 1, frame.epoch
            self._files = {
                name: VideoFile(self.folder / name / f"{self._clip:04d}.mp4")
                for name in ("videos", *_CONTROLS)
            }
            place = _place_of(sample.scene_info("cosmos").scene)
            self._caption = caption(scene_graph(frame), place=place).text
            self._masks = VideoMasks()
            written["clips"] = 1
        for one in sample.scene_info("cosmos").instances:
            self._phrases[one.id] = one.category.replace("_", " ")
        self._masks.add(_even(frame["instance"]))
        self._files["videos"].add(_even(frame["rgb"]), frame.stamp_ns)
        for name, control in _CONTROLS.items():
            self._files[name].add(_even(control(frame)), frame.stamp_ns)
        return WriteResult(written=written)

    def finish(self, records: Sequence[Record]) -> None:
        """Finish the last clip."""
        self._end()

    def _end(self) -> None:
        if not self._files:
            return
        for file in self._files.values():
            file.finish()
        self._files = {}
        name = f"{self._clip:04d}"
        write_bytes(self.folder / "metas" / f"{name}.txt", f"{self._caption}\n".encode())
        masks = self._masks.entries(self._phrases)
        write_bytes(self.folder / "seg" / f"{name}.pickle", pickle.dumps(masks))
        controls = {
            control: {
                "input_control": f"{control}/{name}.mp4",
                "control_weight": 1 / len(_CONTROLS),
            }
            for control in _CONTROLS
        }
        told = {"prompt": self._caption, "input_video_path": f"videos/{name}.mp4", **controls}
        write_bytes(self.folder / "specs" / f"{name}.json", json.dumps(told, indent=1).encode())


def _depth(frame: Frame) -> Picture:
    near, far = 1.0 / NEAREST_M, 1.0 / FARTHEST_M
    depth = np.nan_to_num(frame["depth"], nan=NEAREST_M, posinf=FARTHEST_M)
    share = (1.0 / depth.clip(NEAREST_M, FARTHEST_M) - far) / (near - far)
    return _grey((255.0 * share + 0.5).astype(np.uint8))


def _segments(frame: Frame) -> Picture:
    return colour_instances(frame["instance"])


def _edges(frame: Frame) -> Picture:
    return _grey(np.asarray(cv2.Canny(np.ascontiguousarray(frame["rgb"]), *CANNY), np.uint8))


def _blurred(frame: Frame) -> Picture:
    rgb = np.ascontiguousarray(frame["rgb"])
    return np.asarray(cv2.GaussianBlur(rgb, (0, 0), BLUR_SHARE * len(rgb)), np.uint8)


_CONTROLS: Mapping[str, Callable[[Frame], Picture]] = {
    "depth": _depth,
    "seg": _segments,
    "edge": _edges,
    "vis": _blurred,
}
"""Controls by the names of their folders."""


def _grey(values: NDArray[np.uint8]) -> Picture:
    return np.repeat(values[..., None], 3, axis=2)


def _even(picture: NDArray[Any]) -> NDArray[Any]:
    """Return a picture without the last row or column where their number is odd: videos need it."""
    height, width = (length // 2 * 2 for length in picture.shape[:2])
    return picture[:height, :width]


def _place_of(scene: str) -> str:
    """Return the kind of a generated room in words."""
    prefix, _, kind = scene.partition(":")
    return kind.partition(":")[0].replace("_", " ") if prefix == "generated" else "room"
