"""Frames → WebDataset: tar files of samples, which trainers read from one end to the other.

The layout is that of https://github.com/webdataset/webdataset: members of one sample have one name
and different endings. Values are kept exactly: ``rgb.png``, ``category.png``, ``instance.png`` and
truth values as pictures, every other view as ``<view>.npy``, unless the recipe asks for another
file of a view (`view_files`); ``json`` says where the camera was and
what is known of every visible object, its amodal mask among it (COCO's run lengths) where the
recipe asks for amodal masks.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any, ClassVar

from sailenv_ros.dataset.formats.data_files import discard_drafts, open_draft
from sailenv_ros.dataset.formats.dataset_format import DatasetFormat, Record, Sample, WriteResult
from sailenv_ros.dataset.formats.images import frame_record
from sailenv_ros.dataset.formats.object_records import told_objects
from sailenv_ros.dataset.formats.tar_files import TarWriter
from sailenv_ros.dataset.formats.view_files import encoded

__all__ = ["WebDatasetExport"]


class WebDatasetExport(DatasetFormat):
    """``<split>-00000.tar``, one for each split, or for each shard of a large data set."""

    is_shard: ClassVar[bool] = True
    resumable: ClassVar[bool] = False
    can_compress: ClassVar[bool] = True

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self._open = ExitStack()
        self._tars: dict[str, TarWriter] = {}

    def add(self, sample: Sample) -> WriteResult:
        """Append a frame."""
        tar = self._tar(sample.split or "train")
        frame = sample.frame
        name = f"{sample.number:08d}"
        for view, values in frame.views.items():
            ending, contents = encoded(view, values, self.compression.get(view))
            tar.append(f"{name}.{view}.{ending}", contents)
        record: dict[str, Any] = frame_record(sample.number, frame)
        lens, pose = frame.camera.intrinsics, frame.camera.pose
        record |= {
            "split": sample.split,
            "clip": sample.sequence,
            "agent": frame.agent,
            "epoch": frame.epoch,
            "depth_range_m": frame.depth_range_m,
            "exposure": frame.exposure,
            "lens": lens.arguments(),
            "position": list(pose.position_m),
            "orientation_xyzw": list(pose.orientation_xyzw),
        }
        left_out: dict[str, int] = {}
        if frame.info is not None and "instance" in frame.views:
            record["objects"], left_out = told_objects(sample, "WebDataset")
        tar.append(f"{name}.json", [json.dumps(record).encode()])
        return WriteResult(written={"samples": 1}, left_out=left_out)

    def finish(self, records: Sequence[Record]) -> None:
        """Close the files."""
        for tar in self._tars.values():
            tar.finish()
        self._tars.clear()
        self._open.close()

    def _tar(self, split: str) -> TarWriter:
        if split not in self._tars:
            path = self.folder / f"{split}-{self.part:05d}.tar"
            self._tars[split] = TarWriter(open_draft(self._open, path), path)
        return self._tars[split]

    def close(self) -> None:
        """Remove what is not complete."""
        self._tars.clear()
        discard_drafts(self._open)
