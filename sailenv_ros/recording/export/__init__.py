"""Recorded frames → data sets: one module for each format, and the table of them.

Each format is a class with `add(number, frame, info)` and `finish()`; `export` goes through the
frames of an agent. Knows no ROS.
"""

from __future__ import annotations

from sailenv_ros.recording.export.exporter import FORMATS, export

__all__ = ["FORMATS", "export"]
