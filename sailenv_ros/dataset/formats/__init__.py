"""Frames → data sets: one module for each format, and the table of them.

`DatasetWriter` writes frames as they come, `export` those of a recording. Each format is a class
with `add(sample)` and `finish(records)`. Knows no ROS.
"""

from __future__ import annotations

from sailenv_ros.dataset.formats.dataset_writer import DatasetSummary, DatasetWriter, FormatSummary
from sailenv_ros.dataset.formats.exporter import export
from sailenv_ros.dataset.formats.formats import FORMATS
from sailenv_ros.dataset.formats.splits import Splits

__all__ = ["FORMATS", "DatasetWriter", "FormatSummary", "Splits", "DatasetSummary", "export"]
