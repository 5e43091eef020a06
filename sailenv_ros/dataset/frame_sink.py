"""Where the frames of a shard go: into files, or to the reader of a stream."""

from __future__ import annotations

from typing import Protocol

from sailenv_ros.dataset.shard_plan import Clip
from sailenv_ros.frame.frame import Frame

__all__ = ["FrameSink"]


class FrameSink(Protocol):
    """Takes the frames of a shard, clip by clip; what it raises ends the work."""

    def begin_clip(self, clip: Clip) -> None:
        """Begin with the frames of a clip."""

    def add(self, camera: str, frame: Frame) -> None:
        """Take the next frame of a camera."""

    def end_clip(self) -> None:
        """End the clip: no object of its frames can be drawn alone from now on."""
