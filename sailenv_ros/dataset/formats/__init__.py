"""Frames → data sets: one module for each format, and the table of them.

`DatasetWriter` writes frames as they come, `export` those of a recording. Each format is a class
with `add(sample)` and `finish(records)`. Knows no ROS. What is named here is imported when it is
first used: recordings need the message packages of ROS, readers of other formats do not.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sailenv_ros.dataset.formats.dataset_writer import (
        DatasetSummary,
        DatasetWriter,
        FormatSummary,
    )
    from sailenv_ros.dataset.formats.exporter import export
    from sailenv_ros.dataset.formats.formats import FORMATS
    from sailenv_ros.dataset.formats.splits import Splits

__all__ = ["FORMATS", "DatasetSummary", "DatasetWriter", "FormatSummary", "Splits", "export"]

_HOMES = {
    "FORMATS": "formats",
    "DatasetSummary": "dataset_writer",
    "DatasetWriter": "dataset_writer",
    "FormatSummary": "dataset_writer",
    "Splits": "splits",
    "export": "exporter",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(importlib.import_module(f"{__name__}.{_HOMES[name]}"), name)
    globals()[name] = value
    return value
