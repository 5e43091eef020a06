"""Goes through the frames of one recorded agent and hands them to formats, by name."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from sailenv_ros.dataset.formats.annotation_rules import ALL_OBJECTS, AnnotationRules
from sailenv_ros.dataset.formats.dataset_format import FlowDirection
from sailenv_ros.dataset.formats.dataset_writer import DatasetSummary, DatasetWriter
from sailenv_ros.dataset.formats.formats import check_views, wanted_formats
from sailenv_ros.dataset.formats.splits import Splits
from sailenv_ros.errors import RecordingError
from sailenv_ros.recording.frames import RecordedFrames
from sailenv_ros.recording.reader import RecordingReader

__all__ = ["export"]


def export(
    path: str | Path,
    folder: str | Path,
    formats: Sequence[str],
    *,
    agent: str = "",
    splits: Splits | None = None,
    flow: FlowDirection = "forward",
    rules: AnnotationRules = ALL_OBJECTS,
    undistort: bool = False,
    resume: bool = False,
    on_frame: Callable[[int, int], None] = lambda done, of: None,
) -> DatasetSummary:
    """Write a recording as data sets.

    Parameters
    ----------
    path : str or Path
        A bag folder, or one MCAP file.
    folder : str or Path
        Where to; made if it is not there, else empty. Several formats get a folder each.
    formats : sequence of str
        Names in `FORMATS`.
    agent : str
        Name of the agent; empty if there is only one.
    splits : Splits or None
        How frames are dealt out to train, val and test; None does not split.
    flow : {'forward', 'backward', 'both'}
        Which flow ``kitti`` and ``sintel`` write: to the next frame, to the one before.
    rules : AnnotationRules
        Which objects are annotated.
    undistort : bool
        True writes what pin-holes would see.
    resume : bool
        True continues what an earlier call of the same arguments had to leave unfinished.
    on_frame : callable
        Called with the number of frames that are done and of those there are.

    Returns
    -------
    summary : DatasetSummary
        What was written, and what was left out and why.

    Raises
    ------
    UnknownName, InvalidRequest
        If a format or the agent is unknown, or a view that a format needs was not recorded.
    RecordingError
        If the recording cannot be read or a file not written.
    """
    names = wanted_formats(formats)
    with RecordingReader(path) as reader:
        frames = RecordedFrames(reader, agent)
        for name in names:
            check_views(name, frames.views)
        if not len(frames):
            raise RecordingError(f"{path} has no complete frame of agent {frames.agent!r}")
        source = f"{Path(path).resolve().name}, agent {frames.agent}"
        with DatasetWriter(
            folder,
            names,
            splits=splits,
            flow=flow,
            rules=rules,
            undistort=undistort,
            source=source,
            resume=resume,
        ) as writer:
            for number in range(writer.done, len(frames)):
                writer.add(frames[number])
                on_frame(number + 1, len(frames))
            return writer.finish()
