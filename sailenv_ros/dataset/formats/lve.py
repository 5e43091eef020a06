"""Frames → the folders that the stream readers of SAILab's continual-learning code take ("LVE").

Pictures, motion, dense labels and the rate, 100 frames to a folder; the layout and the sign of the
motion are those of the streams published with arXiv:2204.12193, the units are exact.
"""

from __future__ import annotations

import gzip
import io
import itertools
import statistics
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.dataset.formats.data_files import write_bytes, write_json, write_png
from sailenv_ros.dataset.formats.dataset_format import DatasetFormat, Record, Sample, WriteResult
from sailenv_ros.errors import RecordingError
from sailenv_ros.frame.frame import Frame
from sailenv_ros.system.files import replaced_folder
from sailenv_ros.types.scene_info import SceneInfo

__all__ = ["LveExport", "lve_motion"]

FILES_PER_FOLDER = 100

BACKGROUND = "background"

MAP = "map.json"


def lve_motion(frame: Frame) -> NDArray[np.float32]:
    """Return the displacement of each pixel to the frame before.

    Returns
    -------
    motion : (H, W, 2) float32
        Pixels to the right and pixels **up**; 0 where there is no flow.
    """
    backward = -np.nan_to_num(frame["flow"].astype(np.float64)) * (frame.dt_ns * 1e-9)
    # Without the sum what does not move would be -0.0.
    return np.asarray(backward * (1.0, -1.0) + 0.0, np.float32)


class LveExport(DatasetFormat):
    """SAILab's stream folders: ``frames``, ``motion`` and ``sup``.

    ``frames/00000001/001.png`` is the first picture, ``frames/fps.json`` the rate;
    ``motion/…/001.bin`` the motion of its pixels, see `lve_motion`; ``sup/…/001.targets.bin`` and
    ``001.indices.bin`` a class and an index for every pixel, row by row, ``sup/map.json`` the
    classes by name. Arrays are NumPy files, compressed with gzip. A class is the category of
    objects that can move; all else, also what stands still of the same category, is background.
    Where categories come and go, all of them have their numbers from the first frame on.
    """

    views: ClassVar[tuple[str, ...]] = ("rgb", "instance", "flow")
    is_sequence: ClassVar[bool] = True

    def add(self, sample: Sample) -> WriteResult:
        """Write a frame's files."""
        frame = sample.frame
        place = _place(sample.number)
        classes = _classes(sample.scene_info("lve"))
        targets = _targets(frame, sample.scene_info("lve"), classes)
        write_png(self.folder / "frames" / f"{place}.png", frame["rgb"])
        _write_array(self.folder / "motion" / f"{place}.bin", lve_motion(frame))
        _write_array(self.folder / "sup" / f"{place}.targets.bin", targets)
        indices = np.arange(targets.size, dtype=np.int32)
        _write_array(self.folder / "sup" / f"{place}.indices.bin", indices)
        return WriteResult(
            record={
                "stamp_ns": frame.stamp_ns,
                "epoch": frame.epoch,
                "classes": list(classes.values()),
                "ids": list(classes),
            },
            written={"pictures": 1, "flow fields": 1, "label maps": 1},
        )

    def finish(self, records: Sequence[Record]) -> None:
        """Write the rate and the classes.

        Raises
        ------
        RecordingError
            If the frames are not of one epoch, or are fewer than two.
        """
        values: list[dict[str, Any]] = [record.value for record in records]
        if len({value["epoch"] for value in values}) > 1:
            raise RecordingError("lve needs frames of one epoch; the scene was changed or reset")
        stamps = [value["stamp_ns"] for value in values]
        steps = [after - before for before, after in itertools.pairwise(stamps)]
        if not steps or min(steps) <= 0:
            raise RecordingError("lve needs at least two frames, each later than the one before")
        fps = round(1e9 / statistics.median(steps), 6)
        write_json(self.folder / "frames" / "fps.json", {"fps": fps})
        found = {
            id_: name
            for value in values
            for id_, name in zip(value["ids"], value["classes"], strict=True)
        }
        names = [*(found[id_] for id_ in sorted(found)), BACKGROUND]
        table = {name: place for place, name in enumerate(names)}
        if all(value["classes"] == names[:-1] for value in values):
            write_json(self.folder / "sup" / MAP, table)
        elif not (self.folder / "sup" / MAP).exists():
            self._renumber(records, table)

    def _renumber(self, records: Sequence[Record], table: Mapping[str, int]) -> None:
        """Give all frames the numbers of one table; the folder is the old one or the new one."""
        old = self.folder / "sup"
        with replaced_folder(old) as draft:
            for record in records:
                names = (*record.value["classes"], BACKGROUND)
                numbers = np.array([table[name] for name in names], np.int32)
                file = f"{_place(record.number)}.targets.bin"
                targets = np.load(io.BytesIO(gzip.decompress((old / file).read_bytes())))
                _write_array(draft / file, numbers[targets])
                file = f"{_place(record.number)}.indices.bin"
                write_bytes(draft / file, (old / file).read_bytes())
            write_json(draft / MAP, table)


def _place(number: int) -> str:
    """Return the folder and the name of a frame's files, without their endings."""
    folder, file = divmod(number, FILES_PER_FOLDER)
    return f"{folder + 1:08d}/{file + 1:03d}"


def _classes(info: SceneInfo) -> dict[int, str]:
    """Return the categories of what can move, by their ids, in the order of these."""
    found = {i.category_id: i.category for i in info.instances if not i.static}
    return {id_: found[id_] for id_ in sorted(found)}


def _targets(frame: Frame, info: SceneInfo, classes: Mapping[int, str]) -> NDArray[np.int32]:
    """Return (H·W,) classes, row by row."""
    ids: NDArray[Any] = frame["instance"]
    highest = max([int(ids.max()), *(instance.id for instance in info.instances)])
    table = np.full(highest + 1, len(classes))
    places = {id_: place for place, id_ in enumerate(classes)}
    for instance in info.instances:
        if not instance.static:
            table[instance.id] = places[instance.category_id]
    return np.asarray(table[ids].reshape(-1), np.int32)


def _write_array(path: Path, array: NDArray[Any]) -> None:
    data = io.BytesIO()
    np.save(data, array)
    # Without a time in it, so that the same frames give the same bytes.
    write_bytes(path, gzip.compress(data.getvalue(), compresslevel=6, mtime=0))
