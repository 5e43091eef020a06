"""Frames → WebDataset: tar files of samples, which trainers read from one end to the other.

The layout is that of https://github.com/webdataset/webdataset: members of one sample have one name
and different endings. Values are kept exactly: ``rgb.png``, ``category.png``, ``instance.png`` and
truth values as pictures, every other view as ``<view>.npy``; ``json`` says where the camera was and
what is known of every visible object.
"""

from __future__ import annotations

import io
import json
import tarfile
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import asdict
from pathlib import Path
from typing import Any, BinaryIO, ClassVar

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import RecordingError
from sailenv_ros.recording.export.annotated_objects import annotated_objects
from sailenv_ros.recording.export.data_files import discard_drafts, png_bytes
from sailenv_ros.recording.export.dataset_format import DatasetFormat, Made, Record, Sample
from sailenv_ros.recording.export.image_formats import frame_record
from sailenv_ros.recording.export.object_records import object_record
from sailenv_ros.system.files import make_folder, written_file

__all__ = ["WebDatasetExport"]


class WebDatasetExport(DatasetFormat):
    """``<split>-00000.tar``, one for each split, or for each shard of a large data set."""

    is_shard: ClassVar[bool] = True
    resumable: ClassVar[bool] = False

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self._open = ExitStack()
        self._tars: dict[str, tarfile.TarFile] = {}

    def add(self, sample: Sample) -> Made:
        """Append a frame."""
        tar = self._tar(sample.split or "train")
        frame = sample.frame
        name = f"{sample.number:08d}"
        for view, values in frame.views.items():
            ending, data = encoded(values)
            _append(tar, f"{name}.{view}.{ending}", data)
        record: dict[str, Any] = frame_record(sample.number, frame)
        lens, pose = frame.camera.intrinsics, frame.camera.pose
        record |= {
            "split": sample.split,
            "clip": sample.sequence,
            "agent": frame.agent,
            "epoch": frame.epoch,
            "depth_range_m": frame.depth_range_m,
            "lens": asdict(lens),
            "position": list(pose.position_m),
            "orientation_xyzw": list(pose.orientation_xyzw),
        }
        left_out: dict[str, int] = {}
        if frame.info is not None and "instance" in frame.views:
            found = annotated_objects(sample, "WebDataset")
            record["objects"] = [object_record(found.table, row) for row in range(len(found.table))]
            left_out = dict(found.left_out)
        _append(tar, f"{name}.json", json.dumps(record).encode())
        return Made(written={"samples": 1}, left_out=left_out)

    def finish(self, records: Sequence[Record]) -> None:
        """Close the files."""
        self._open.close()
        self._tars.clear()

    def _tar(self, split: str) -> tarfile.TarFile:
        if split not in self._tars:
            path = self.folder / f"{split}-{self.part:05d}.tar"
            try:
                make_folder(self.folder)
                file: BinaryIO = self._open.enter_context(written_file(path, durable=False))
            except OSError as problem:
                raise RecordingError(f"{path} cannot be written: {problem.strerror}") from None
            self._tars[split] = self._open.enter_context(
                tarfile.TarFile(fileobj=file, mode="w", format=tarfile.USTAR_FORMAT)
            )
        return self._tars[split]

    def close(self) -> None:
        """Remove what is not complete."""
        self._tars.clear()
        discard_drafts(self._open)


def encoded(values: NDArray[Any]) -> tuple[str, bytes]:
    """Return the ending and the content of the member that keeps a view's values exactly."""
    if values.dtype == np.bool_:
        return "png", png_bytes(values.astype(np.uint8) * np.uint8(255))
    if values.dtype in (np.uint8, np.uint16):
        return "png", png_bytes(values)
    data = io.BytesIO()
    np.save(data, np.ascontiguousarray(values), allow_pickle=False)
    return "npy", data.getvalue()


def _append(tar: tarfile.TarFile, name: str, data: bytes) -> None:
    # Nothing of this machine or moment: the same frames are the same bytes.
    member = tarfile.TarInfo(name)
    member.size, member.mtime, member.mode = len(data), 0, 0o644
    try:
        tar.addfile(member, io.BytesIO(data))
    except OSError as problem:
        raise RecordingError(f"the tar file cannot be written: {problem.strerror}") from None
