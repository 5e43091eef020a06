"""Frames → MCAP: a bag of the topics that a simulator would publish.

`RecordingReader`, `sailenv play`, `ros2 bag` and Foxglove open it.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import ClassVar

from sailenv_ros.dataset.formats.dataset_format import DatasetFormat, Record, Sample, WriteResult
from sailenv_ros.recording.lockstep import FrameRecorder
from sailenv_ros.recording.topics import RecordingOptions
from sailenv_ros.recording.writer import RecordingWriter

__all__ = ["McapExport"]


class McapExport(DatasetFormat):
    """The folder ``bag``: an MCAP file and its ``metadata.yaml``; one sequence."""

    is_sequence: ClassVar[bool] = True
    resumable: ClassVar[bool] = False

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self._open = ExitStack()
        self._recorder: FrameRecorder | None = None
        self._revision: tuple[int, int] | None = None

    def add(self, sample: Sample) -> WriteResult:
        """Append a frame, and the scene where it is another one than before."""
        frame = sample.frame
        if self._recorder is None:
            writer = RecordingWriter(self.folder / "bag", RecordingOptions())
            self._recorder = FrameRecorder(self._open.enter_context(writer))
        info = sample.scene_info("MCAP")
        if (info.epoch, info.revision) != self._revision:
            self._revision = info.epoch, info.revision
            self._recorder.write_info(info)
        amodal = frame.draw_amodal is not None
        self._recorder.write_frame(frame, frame.depth_range_m, amodal=amodal)
        return WriteResult(written={"frames": 1})

    def finish(self, records: Sequence[Record]) -> None:
        """Close the bag."""
        self._open.close()
        self._recorder = None

    def close(self) -> None:
        """Close the bag; what was written can be read."""
        self.finish(())
