"""Goes through the frames of one recorded agent and hands them to formats, by name."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import ClassVar, Protocol

from sailenv_ros.errors import InvalidRequest, RecordingError, UnknownName
from sailenv_ros.frame import Frame
from sailenv_ros.recording.export.coco_export import CocoExport
from sailenv_ros.recording.export.data_files import finish, make_folder
from sailenv_ros.recording.export.image_formats import FloExport, KittiExport, PngExport
from sailenv_ros.recording.export.video import VideoExport
from sailenv_ros.recording.frames import RecordedFrames
from sailenv_ros.recording.reader import RecordingReader
from sailenv_ros.scene_info import SceneInfo

__all__ = ["FORMATS", "Export", "export"]


class Export(Protocol):
    """One format."""

    views: ClassVar[tuple[str, ...]]
    """Views that it is made of; none means whatever there is."""

    def __init__(self, folder: Path) -> None: ...

    def add(self, number: int, frame: Frame, info: SceneInfo | None) -> None:
        """Take a frame."""

    def finish(self) -> None:
        """Write what is written once all frames were taken."""


FORMATS: dict[str, type[Export]] = {
    "png": PngExport,
    "coco": CocoExport,
    "kitti": KittiExport,
    "flo": FloExport,
    "mp4": VideoExport,
}
"""Each format by its name."""


def export(
    path: str | Path,
    folder: str | Path,
    formats: Sequence[str],
    *,
    agent: str = "",
    on_frame: Callable[[int, int], None] = lambda done, of: None,
) -> int:
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
    on_frame : callable
        Called with the number of frames that are done and of those there are.

    Returns
    -------
    count : int
        Frames that were written.

    Raises
    ------
    UnknownName, InvalidRequest
        If a format or the agent is unknown, or a view that a format needs was not recorded.
    RecordingError
        If the recording cannot be read or a file not written.
    """
    names = list(dict.fromkeys(formats))
    for name in names:
        if name not in FORMATS:
            raise UnknownName("format", name, FORMATS)
    if not names:
        raise InvalidRequest("formats", (), f"at least one of: {', '.join(FORMATS)}")
    with RecordingReader(path) as reader:
        frames = RecordedFrames(reader, agent)
        for name in names:
            _check_views(name, frames.views)
        if not len(frames):
            raise RecordingError(f"{path} has no complete frame of agent {frames.agent!r}")
        target = Path(folder)
        make_folder(target)
        exports = [FORMATS[n](target / n if len(names) > 1 else target) for n in names]
        for number, frame in enumerate(frames):
            info = frames.scene_info(number)
            for made in exports:
                made.add(number, frame, info)
            on_frame(number + 1, len(frames))
        for made in exports:
            made.finish()
        finish(target)
        return len(frames)


def _check_views(name: str, views: Sequence[str]) -> None:
    needed = FORMATS[name].views
    # KITTI has a folder for each view, which may be missing; the others need all of theirs.
    lacking = [view for view in needed if view not in views]
    if lacking and (name != "kitti" or len(lacking) == len(needed)):
        accepted = f"recorded with the views that {name} needs: {', '.join(needed)}"
        raise InvalidRequest("recording", f"the views {', '.join(views)}", accepted)
