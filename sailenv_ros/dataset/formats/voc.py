"""Frames → Pascal VOC: an XML file of boxes for each picture, masks in colours, lists of names.

The layout is that of the VOC2012 development kit, http://host.robots.ox.ac.uk/pascal/VOC/. Pixels
count from 1 there.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar
from xml.etree import ElementTree

import numpy as np

from sailenv_ros.dataset.formats.annotated_objects import annotated_objects
from sailenv_ros.dataset.formats.data_files import write_bytes, write_png
from sailenv_ros.dataset.formats.dataset_format import DatasetFormat, Record, Sample, WriteResult
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.truth.object_table import ObjectTable

__all__ = ["VocExport"]

OCCLUDED = 0.05
"""Share of an object that is hidden if it counts as occluded, as the annotators' guidelines say."""


class VocExport(DatasetFormat):
    """`JPEGImages` (PNG files), `Annotations`, `SegmentationObject` and `ImageSets/Main`."""

    views: ClassVar[tuple[str, ...]] = ("rgb", "instance")

    def add(self, sample: Sample) -> WriteResult:
        """Write the files of a frame."""
        found = annotated_objects(sample, "Pascal VOC")
        name = f"{sample.stem}.png"
        write_png(self.folder / "JPEGImages" / name, sample.frame["rgb"])
        # Numbers of objects in the order of the XML file.
        numbers = np.zeros(65536, np.uint16)
        numbers[found.table.ids] = np.arange(1, len(found.table) + 1)
        write_png(self.folder / "SegmentationObject" / name, numbers[sample.frame["instance"]])
        tree = _annotation(name, sample.frame, found.table)
        path = self.folder / "Annotations" / f"{sample.stem}.xml"
        write_bytes(path, ElementTree.tostring(tree))
        return WriteResult(
            written={"pictures": 1, "objects": len(found.table)}, left_out=found.left_out
        )

    def finish(self, records: Sequence[Record]) -> None:
        """Write the list of each split's names."""
        for split in sorted({record.split for record in records}):
            names = [f"{record.number:06d}\n" for record in records if record.split == split]
            path = self.folder / "ImageSets" / "Main" / f"{split or 'trainval'}.txt"
            write_bytes(path, "".join(names).encode())


def _annotation(name: str, frame: Frame, table: ObjectTable) -> ElementTree.Element:
    height, width = frame["instance"].shape
    root = ElementTree.Element("annotation")
    _add(root, folder="VOC", filename=name)
    _add(ElementTree.SubElement(root, "source"), database="sailenv_ros")
    _add(ElementTree.SubElement(root, "size"), width=width, height=height, depth=3)
    _add(root, segmented=1)
    hidden, beside = 1.0 - table.visible_share, table.truncated_share
    for row, (left, top, right, bottom) in enumerate(table.visible_boxes.tolist()):
        entry = ElementTree.SubElement(root, "object")
        # Without amodal masks what touches the border counts as truncated.
        touches = left == 0 or top == 0 or right == width - 1 or bottom == height - 1
        known = table.whole_pixels[row] >= 0
        _add(
            entry,
            name=table.categories[row],
            pose="Unspecified",
            truncated=int(beside[row] > 0.0 if known else touches),
            occluded=int(known and hidden[row] > OCCLUDED),
            difficult=0,
        )
        box = ElementTree.SubElement(entry, "bndbox")
        _add(box, xmin=left + 1, ymin=top + 1, xmax=right + 1, ymax=bottom + 1)
    ElementTree.indent(root)
    return root


def _add(parent: ElementTree.Element, **values: Any) -> None:
    for name, value in values.items():
        ElementTree.SubElement(parent, name).text = str(value)
