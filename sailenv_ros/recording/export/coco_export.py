"""Frames → COCO's instance annotations: masks as run lengths, boxes, categories.

The format is that of https://cocodataset.org/#format-data. An annotation is one object in one
picture; `instance_id` joins those of one object.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import RecordingError
from sailenv_ros.frame import Frame
from sailenv_ros.recording.export.data_files import write_json, write_png
from sailenv_ros.recording.export.image_formats import frame_record
from sailenv_ros.scene_info import SceneInfo

__all__ = ["CocoExport", "run_lengths", "run_lengths_text"]

_NO_CATEGORY = (0, 255)
"""Background and unlabelled."""


class CocoExport:
    """`images/*.png` and `annotations.json`."""

    views: ClassVar[tuple[str, ...]] = ("rgb", "instance")

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._images: list[dict[str, Any]] = []
        self._annotations: list[dict[str, Any]] = []
        self._categories: dict[int, str] = {}

    def add(self, number: int, frame: Frame, info: SceneInfo | None) -> None:
        """Write the picture of a frame and take its objects."""
        if info is None:
            raise RecordingError("COCO needs the scene_info, which was not recorded")
        name = f"{number:06d}.png"
        write_png(self._folder / "images" / name, frame["rgb"])
        height, width = frame["instance"].shape
        image = {"id": number, "file_name": name, "width": width, "height": height}
        self._images.append({**frame_record(number, frame), **image})
        for category in info.categories.values():
            if category.id not in _NO_CATEGORY:
                self._categories[category.id] = category.name
        objects = {instance.id: instance for instance in info.instances}
        for instance_id in np.unique(frame["instance"]).tolist():
            instance = objects.get(instance_id)
            if instance is not None and instance.category_id not in _NO_CATEGORY:
                annotation = _annotation(frame["instance"] == instance_id)
                self._annotations.append(
                    {
                        "id": len(self._annotations) + 1,
                        "image_id": number,
                        "category_id": instance.category_id,
                        "instance_id": instance_id,
                        "instance_name": instance.name,
                        **annotation,
                    }
                )

    def finish(self) -> None:
        """Write the annotations."""
        table = {
            "info": {"description": "recorded by sailenv_ros"},
            "images": self._images,
            "annotations": self._annotations,
            "categories": [
                {"id": number, "name": name, "supercategory": ""}
                for number, name in sorted(self._categories.items())
            ],
        }
        write_json(self._folder / "annotations.json", table)


def _annotation(mask: NDArray[np.bool_]) -> dict[str, Any]:
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    x, y = int(columns[0]), int(rows[0])
    return {
        "segmentation": {
            "size": list(mask.shape),
            "counts": run_lengths_text(run_lengths(mask)),
        },
        "area": int(mask.sum()),
        "bbox": [x, y, int(columns[-1]) - x + 1, int(rows[-1]) - y + 1],
        "iscrowd": 0,
    }


def run_lengths(mask: NDArray[np.bool_]) -> list[int]:
    """Return lengths of runs of a mask, column by column: first of False, which may be 0."""
    flat = mask.ravel(order="F")
    changes = np.flatnonzero(flat[1:] != flat[:-1]) + 1
    lengths = np.diff(np.concatenate([[0], changes, [flat.size]])).tolist()
    return [0, *lengths] if flat.size and flat[0] else lengths


def run_lengths_text(lengths: list[int]) -> str:
    """Write run lengths as COCO does: five bits a letter, from the third on as differences.

    P. Dollár, T.-Y. Lin, common/maskApi.c of the COCO API: rleToString.
    """
    text = []
    for number, length in enumerate(lengths):
        value = length - lengths[number - 2] if number > 2 else length
        more = True
        while more:
            bits = value & 0x1F
            value >>= 5
            # Ends where the rest is but the sign that the last of the five bits says.
            more = value != (-1 if bits & 0x10 else 0)
            text.append(chr((bits | 0x20 if more else bits) + 48))
    return "".join(text)
